#include <weir/pass/plugin.h>

#include "restir_di/restir_di.h"

WEIR_PLUGIN("restir_di", weir::passEntry<weir::passes::Initial>("Initial"),
            weir::passEntry<weir::passes::Temporal>("Temporal"), weir::passEntry<weir::passes::Spatial>("Spatial"),
            weir::passEntry<weir::passes::Shade>("Shade"))
