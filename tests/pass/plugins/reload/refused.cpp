// Describes itself wrongly: the registry refuses it after it was opened.
#define RELOAD_TEXT "3"
#include "reload.h"

namespace {

class Throws final : public weir::Pass {
 public:
  static void describe(weir::PassDescription&) { throw weir::InputError("half-finished"); }
  void prepare(weir::PrepareContext&) override {}
  void record(weir::RecordContext&) override {}
};

}  // namespace

WEIR_PLUGIN("reload", weir::passEntry<Reloaded>("It"), weir::passEntry<Throws>("Throws"))
