#include "common/layouts.h"
#include "floor/floor.h"

namespace weir::passes {

void ShadowRays::describe(PassDescription& d) {
  d.doc("The shadow ray of each pixel's reservoir and nothing else: what visibility costs at the least");
  d.input("surface", perPixel<PackedSurface>());
  d.input("reservoirs", perPixel<Reservoir>()).anyCount().doc("The first of each pixel counts");
  d.output("transmittance", storageImage(Format::R32F)).doc("0: hidden, 1: seen; -1 where there is no sample");
  d.needs(Need::SceneGeometry).needs(Need::SceneMaterials).needs(Need::SceneLights).needs(Need::SceneAcceleration);
  d.needs(Need::FrameCamera);
}

void ShadowRays::prepare(PrepareContext& c) {
  kernel_ = c.rayKernel("shadow_rays.glsl");
}

void ShadowRays::record(RecordContext& c) {
  c.launch(kernel_);
}

}  // namespace weir::passes
