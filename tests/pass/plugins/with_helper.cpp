// A plugin that brought a library of its own, which lies beside it.
#include "test_pass.h"

extern "C" const char* weirTestHelperText();

namespace {

class Helped final : public TestPass {
 public:
  static void describe(weir::PassDescription& d) {
    TestPass::describe(d);
    d.doc(weirTestHelperText());
  }
};

}  // namespace

WEIR_PLUGIN("with_helper", weir::passEntry<Helped>("Helped"))
