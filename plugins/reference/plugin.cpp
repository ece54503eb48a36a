#include <weir/pass/plugin.h>

#include "reference/all_lights.h"
#include "reference/path_tracer.h"

WEIR_PLUGIN("reference", weir::passEntry<weir::passes::AllLights>("AllLights"),
            weir::passEntry<weir::passes::PathTracer>("PathTracer"))
