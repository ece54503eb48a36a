// The smallest complete pass. CONTRIBUTING.md, "Adding a pass", says how to make another one from it.
#pragma once

#include <weir/pass/pass.h>

namespace weir::passes {

/// Multiplies a picture by a factor.
class Scale final : public Pass {
 public:
  /// Ports, parameters and what it takes from scene and frame: static, so that graphs are checked without a device.
  static void describe(PassDescription& d);
  /// Once for a compiled graph: asks for the kernels.
  void prepare(PrepareContext& c) override;
  /// Every frame: launches them.
  void record(RecordContext& c) override;

 private:
  Kernel kernel_;
};

}  // namespace weir::passes
