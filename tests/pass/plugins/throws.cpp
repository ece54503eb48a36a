#include "test_pass.h"

#include <weir/core/error.h>

namespace {

class Throws final : public TestPass {
 public:
  static void describe(weir::PassDescription&) { throw weir::InputError("the tables are missing"); }
};

}  // namespace

WEIR_PLUGIN("throws", weir::passEntry<TestPass>("Nothing"), weir::passEntry<Throws>("Throws"))
