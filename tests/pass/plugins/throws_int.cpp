#include "test_pass.h"

namespace {

class Throws final : public TestPass {
 public:
  static void describe(weir::PassDescription&) { throw 42; }
};

}  // namespace

WEIR_PLUGIN("throws_int", weir::passEntry<Throws>("Throws"))
