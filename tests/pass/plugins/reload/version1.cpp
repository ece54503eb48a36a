#define RELOAD_TEXT "1"
#include "reload.h"

WEIR_PLUGIN("reload", weir::passEntry<Reloaded>("It"), weir::passEntry<Reloaded>("Gone"))
