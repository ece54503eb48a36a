#include "test_pass.h"

namespace {

class Contradicts final : public TestPass {
 public:
  static void describe(weir::PassDescription& d) { d.param("amount", 3.0f).range(0, 2); }
};

}  // namespace

WEIR_PLUGIN("contradicts", weir::passEntry<Contradicts>("Contradicts"))
