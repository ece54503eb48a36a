#include <weir/pass/plugin.h>

#include "output/accumulate.h"
#include "output/tonemap.h"

WEIR_PLUGIN("output", weir::passEntry<weir::passes::Tonemap>("Tonemap"),
            weir::passEntry<weir::passes::Accumulate>("Accumulate"))
