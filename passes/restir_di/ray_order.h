// Shadow rays in an order in which they are traced faster: shaders/restir_di/ray_order.glsl.
#pragma once

#include <weir/pass/pass.h>

#include <array>
#include <cstdint>

namespace weir::passes {

inline constexpr uint32_t kTileSide = 16;

/// Which pixel of its tile has the ray, counted by rows; ~0: none.
struct RayPlace {
  uint32_t pixel;
};

/// Of the rays of every tile of 16 x 16 pixels, one a pixel.
PortType rayOrder();
/// A compute kernel that puts its pixels' rays into scratch_order.
KernelOptions ordersRays();
/// Shoots them: a linear rayKernel.
void launchRays(RecordContext& c, Kernel kernel);

}  // namespace weir::passes

namespace weir {

template <>
struct LayoutOf<passes::RayPlace> {
  static constexpr const char* name = "RayPlace";
  static constexpr uint32_t version = 1, emptyWord = 0;
  static constexpr std::array<Field, 1> fields{{{"uint", "pixel"}}};
};

}  // namespace weir
