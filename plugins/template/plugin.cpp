#include <weir/pass/plugin.h>

#include "template/scale.h"

WEIR_PLUGIN("template", weir::passEntry<weir::passes::Scale>("Scale"))
