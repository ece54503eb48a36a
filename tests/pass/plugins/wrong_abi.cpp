#include "test_pass.h"

#undef WEIR_ABI_VERSION
#define WEIR_ABI_VERSION 999

WEIR_PLUGIN("wrong_abi", weir::passEntry<TestPass>("Nothing"))
