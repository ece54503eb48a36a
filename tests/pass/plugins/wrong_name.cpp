#include "test_pass.h"

WEIR_PLUGIN("another_name", weir::passEntry<TestPass>("Nothing"))
