#include "common/layouts.h"
#include "restir_di/restir_di.h"

namespace weir::passes {

void Shade::describe(PassDescription& d) {
  d.doc("Turns reservoirs into radiance: the mean over a pixel's samples, and what the surface itself emits");
  d.input("surface", perPixel<PackedSurface>());
  d.input("emission", storageImage(Format::RGBA32F));
  d.input("reservoirs", perPixel<Reservoir>()).anyCount();
  d.input("light", storageImage(Format::RGBA32F))
      .optional()
      .doc("Spatial's: with it the chosen sample says only how much of the light of all merged ones is hidden");
  d.output("reservoirs", perPixel<Reservoir>())
      .countOf("reservoirs")
      .passesThrough("reservoirs")
      .doc("What came in, marked with what the final rays found: a history that needs fewer rays");
  d.output("color", storageImage(Format::RGBA32F)).radiance();
  d.param("visibility", true).specialises().doc("Shoot the final shadow ray; without it, light goes through walls");
  d.needs(Need::SceneGeometry).needs(Need::SceneMaterials).needs(Need::SceneLights).needs(Need::SceneAcceleration);
  d.needs(Need::FrameCamera);
}

void Shade::prepare(PrepareContext& c) {
  visibility_ = c.boolean("visibility");
  if (!visibility_) {
    kernel_ = c.kernel("shade.glsl");
    return;
  }
  rays_.scratch(c);
  kernel_ = c.kernel("shade.glsl", {.defines = {{"FINAL_VISIBILITY", "1"}}});
  rays_.prepare(c, "shade_visibility.glsl");
}

void Shade::record(RecordContext& c) {
  c.launch(kernel_);
  if (visibility_) rays_.launch(c);
}

}  // namespace weir::passes
