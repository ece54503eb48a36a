#include "test_pass.h"

#undef WEIR_BUILD_TAG
#define WEIR_BUILD_TAG "weir-0.0-Watcom1"

WEIR_PLUGIN("wrong_tag", weir::passEntry<TestPass>("Nothing"))
