#include "test_pass.h"

#include <stdexcept>

namespace {

class CannotBeMade final : public TestPass {
 public:
  CannotBeMade() { throw std::runtime_error("no room"); }
};

}  // namespace

WEIR_PLUGIN("good", weir::passEntry<TestPass>("Nothing"), weir::passEntry<CannotBeMade>("CannotBeMade"))
