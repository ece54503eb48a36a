#include <weir/pass/plugin.h>

#include "floor/floor.h"

WEIR_PLUGIN("floor", weir::passEntry<weir::passes::CameraRays>("CameraRays"),
            weir::passEntry<weir::passes::ShadowRays>("ShadowRays"), weir::passEntry<weir::passes::Buffers>("Buffers"))
