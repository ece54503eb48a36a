#include "common/layouts.h"
#include "restir_di/restir_di.h"

namespace weir::passes {

void Temporal::describe(PassDescription& d) {
  d.doc("Merges each pixel's reservoirs with those its surface had last frame");
  d.input("surface", perPixel<PackedSurface>());
  d.input("motion", storageImage(Format::RG32F));
  d.input("previousSurface", perPixel<PackedSurface>()).doc("The surface port, @previous");
  d.input("reservoirs", perPixel<Reservoir>()).anyCount();
  d.input("history", perPixel<Reservoir>()).anyCount().doc("The last reuse's reservoirs, @previous");
  d.output("reservoirs", perPixel<Reservoir>()).countOf("reservoirs").passesThrough("reservoirs");
  d.param("confidenceCap", 20).range(1, 1024).unit("frames").doc("Most that the history counts, in fresh frames");
  describeReuse(d);
  d.needs(Need::SceneGeometry).needs(Need::SceneMaterials).needs(Need::SceneLights).needs(Need::SceneAcceleration);
  d.needs(Need::FrameCamera).needs(Need::FrameIndex).needsPrevious(Need::FrameCamera);
  d.needsPrevious(Need::SceneLights).needsPrevious(Need::SceneAcceleration);
}

void Temporal::prepare(PrepareContext& c) {
  kernel_ = reuseKernel(c, "temporal.glsl");
}

void Temporal::record(RecordContext& c) {
  c.launch(kernel_);
}

}  // namespace weir::passes
