#include "test_pass.h"

WEIR_PLUGIN("twice", weir::passEntry<TestPass>("Nothing"), weir::passEntry<TestPass>("Nothing"))
