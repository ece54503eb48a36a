#include <weir/pass/plugin.h>

#include "gbuffer/gbuffer.h"

WEIR_PLUGIN("gbuffer", weir::passEntry<weir::passes::RayTraced>("RayTraced"),
            weir::passEntry<weir::passes::Raster>("Raster"))
