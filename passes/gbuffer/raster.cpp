#include "gbuffer/gbuffer.h"

#include "common/layouts.h"

namespace weir::passes {

void describeGBuffer(PassDescription& d) {
  d.output("surface", perPixel<PackedSurface>()).doc("First visible surface; distance 0 where there is none");
  d.output("emission", storageImage(Format::RGBA32F))
      .radiance()
      .doc("What the surface itself emits, nit; alpha 1 where there is one. Elsewhere the environment, alpha 0");
  d.output("motion", storageImage(Format::RG32F))
      .doc("Where the surface was in the last frame minus where it is, pixels");
  d.param("jitter", false).doc("Sample a new place in the pixel's box every frame, the same in all pixels");
  d.needs(Need::SceneGeometry).needs(Need::SceneMaterials).needs(Need::SceneEnvironment);
  d.needs(Need::FrameCamera).needs(Need::FrameIndex);
  d.needsPrevious(Need::FrameCamera).needsPrevious(Need::SceneGeometry);
}

void Raster::describe(PassDescription& d) {
  d.doc("First visible surfaces by rasterisation; needs no ray tracing").rasterises();
  describeGBuffer(d);
}

void Raster::prepare(PrepareContext& c) {
  c.scratch("drawn", storageImage(Format::R32U));
  raster_ = c.rasterKernel("raster.glsl", "drawn");
  resolve_ = c.kernel("raster_resolve.glsl");
}

void Raster::record(RecordContext& c) {
  c.draw(raster_);
  c.launch(resolve_);
}

}  // namespace weir::passes
