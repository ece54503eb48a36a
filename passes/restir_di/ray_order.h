// Shadow rays in an order in which they are traced faster: shaders/restir_di/ray_order.glsl.
#pragma once

#include <weir/pass/pass.h>

#include <array>
#include <cstdint>

namespace weir::passes {

/// A ray's key, or whose ray it is.
struct RayWord {
  uint32_t bits;
};

/// What a pass with such rays holds: scratch_keys, which a kernel of its own fills, and scratch_order, by which a
/// linear rayKernel shoots them.
class RayOrder {
 public:
  /// Before the pass's first kernel.
  void scratch(PrepareContext& c);
  void prepare(PrepareContext& c, const char* rayKernel);
  /// Sorts and shoots, after the keys were written.
  void launch(RecordContext& c) const;

 private:
  Kernel order_, rays_;
};

}  // namespace weir::passes

namespace weir {

template <>
struct LayoutOf<passes::RayWord> {
  static constexpr const char* name = "RayWord";
  static constexpr uint32_t version = 1, emptyWord = 0;
  static constexpr std::array<Field, 1> fields{{{"uint", "bits"}}};
};

}  // namespace weir
