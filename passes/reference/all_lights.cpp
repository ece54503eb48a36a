#include "reference/all_lights.h"

#include "common/layouts.h"

namespace weir::passes {

void AllLights::describe(PassDescription& d) {
  d.doc(
      "Direct light by a shadow ray to every punctual light and stratified samples of emissive triangles and "
      "environment");
  d.input("surface", perPixel<PackedSurface>());
  d.input("emission", storageImage(Format::RGBA32F));
  d.output("color", storageImage(Format::RGBA32F)).radiance();
  d.param("samples", 1).range(1, 16).doc("Strata a side on each emissive triangle and of the environment: n² rays");
  d.param("environment", "importance")
      .oneOf({"importance", "uniform"})
      .doc(
          "Directions by the environment's table and by the BSDF, or uniform over the sphere: noisy, but free of both");
  d.needs(Need::SceneGeometry).needs(Need::SceneMaterials).needs(Need::SceneLights).needs(Need::SceneAcceleration);
  d.needs(Need::FrameCamera).needs(Need::FrameIndex);
}

void AllLights::prepare(PrepareContext& c) {
  kernel_ = c.rayKernel("all_lights.glsl");
}

void AllLights::record(RecordContext& c) {
  c.launch(kernel_);
}

}  // namespace weir::passes
