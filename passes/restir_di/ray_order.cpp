#include "restir_di/ray_order.h"

namespace weir::passes {
namespace {

constexpr uint32_t kRegionSide = 64, kRegionRays = kRegionSide * kRegionSide;
constexpr uint32_t kSortSide = 32;  ///< of the workgroup that sorts a region: an invocation for each key

uint32_t regions(uint32_t side) {
  return (side + kRegionSide - 1) / kRegionSide;
}

}  // namespace

void RayOrder::scratch(PrepareContext& c) {
  c.scratch("keys", perPixel<RayWord>());
  PortType order = perPixel<RayWord>();
  order.scaleDenominator = kRegionSide;
  order.perPixel = kRegionRays;
  c.scratch("order", order);
}

void RayOrder::prepare(PrepareContext& c, const char* rayKernel) {
  order_ = c.kernel("order_rays.glsl", {.group = {.side = kSortSide, .whole = true}});
  rays_ = c.rayKernel(rayKernel, {.linear = true});
}

void RayOrder::launch(RecordContext& c) const {
  const uint32_t across = regions(c.width()), down = regions(c.height());
  c.launch(order_, across * kSortSide, down * kSortSide, 0);
  c.launch(rays_, across * down * kRegionRays, 1, 0);
}

}  // namespace weir::passes
