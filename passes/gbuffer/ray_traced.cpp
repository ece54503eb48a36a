#include "gbuffer/gbuffer.h"

#include "common/layouts.h"

#include <cstdlib>

namespace weir::passes {
struct RayHit {
  uint32_t triangle, instance;
  float barycentrics[2];
};
}  // namespace weir::passes

namespace weir {
template <>
struct LayoutOf<passes::RayHit> {
  static constexpr const char* name = "RayHit";
  static constexpr uint32_t version = 1, emptyWord = 0;
  static constexpr std::array<Field, 3> fields{{{"uint", "triangle"}, {"uint", "instance"}, {"vec2", "barycentrics"}}};
};
}  // namespace weir

namespace weir::passes {

void RayTraced::describe(PassDescription& d) {
  d.doc("First visible surfaces by one ray a pixel");
  describeGBuffer(d);
  d.needs(Need::SceneAcceleration);
}

void RayTraced::prepare(PrepareContext& c) {
  split_ = std::getenv("WEIR_SPLIT") != nullptr;
  if (split_) {
    c.scratch("hits", perPixel<RayHit>());
    kernel_ = c.rayKernel("ray_hits.glsl");
    surfaces_ = c.kernel("ray_surfaces.glsl");
    return;
  }
  kernel_ = c.rayKernel("ray_traced.glsl");
}

void RayTraced::record(RecordContext& c) {
  c.launch(kernel_);
  if (split_) c.launch(surfaces_);
}

}  // namespace weir::passes
