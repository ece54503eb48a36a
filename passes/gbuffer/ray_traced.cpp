#include "gbuffer/gbuffer.h"

namespace weir::passes {

void RayTraced::describe(PassDescription& d) {
  d.doc("First visible surfaces by one ray a pixel");
  describeGBuffer(d);
  d.needs(Need::SceneAcceleration);
}

void RayTraced::prepare(PrepareContext& c) {
  kernel_ = c.rayKernel("ray_traced.glsl");
}

void RayTraced::record(RecordContext& c) {
  c.launch(kernel_);
}

}  // namespace weir::passes
