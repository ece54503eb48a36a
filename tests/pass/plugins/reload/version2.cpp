#define RELOAD_TEXT "2"
#include "reload.h"

WEIR_PLUGIN("reload", weir::passEntry<Reloaded>("It"), weir::passEntry<Reloaded>("Added"))
