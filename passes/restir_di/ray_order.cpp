#include "restir_di/ray_order.h"

namespace weir::passes {

PortType rayOrder() {
  PortType type = perPixel<RayPlace>();
  type.scaleDenominator = kTileSide;
  type.perPixel = kTileSide * kTileSide;
  return type;
}

KernelOptions ordersRays() {
  KernelOptions options;
  options.defines.emplace_back("ORDERS_RAYS", "1");
  options.group = {.side = kTileSide, .whole = true};
  return options;
}

void launchRays(RecordContext& c, Kernel kernel) {
  const auto tiles = [](uint32_t side) { return (side + kTileSide - 1) / kTileSide; };
  c.launch(kernel, tiles(c.width()) * tiles(c.height()) * kTileSide * kTileSide, 1, 0);
}

}  // namespace weir::passes
