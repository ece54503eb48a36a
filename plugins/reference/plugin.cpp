#include <weir/pass/plugin.h>

#include "reference/all_lights.h"

WEIR_PLUGIN("reference", weir::passEntry<weir::passes::AllLights>("AllLights"))
