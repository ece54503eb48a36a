#include "common/layouts.h"
#include "restir_di/restir_di.h"
#include <cstdlib>

namespace weir::passes {

void Shade::describe(PassDescription& d) {
  d.doc("Turns reservoirs into radiance: the mean over a pixel's samples, and what the surface itself emits");
  d.input("surface", perPixel<PackedSurface>());
  d.input("emission", storageImage(Format::RGBA32F));
  d.input("reservoirs", perPixel<Reservoir>()).anyCount();
  d.output("tested", perPixel<Reservoir>())
      .countOf("reservoirs")
      .doc("The reservoirs with what the final rays found, for a VisibilityCache");
  d.output("color", storageImage(Format::RGBA32F)).radiance();
  d.param("visibility", true).specialises().doc("Shoot the final shadow ray; without it, light goes through walls");
  d.needs(Need::SceneGeometry).needs(Need::SceneMaterials).needs(Need::SceneLights).needs(Need::SceneAcceleration);
  d.needs(Need::FrameCamera);
}

void Shade::prepare(PrepareContext& c) {
  split_ = getenv("WEIR_SHADESPLIT") != nullptr;
  if (split_) {
    kernel_ = c.kernel("shade.glsl");
    rays_ = c.rayKernel("shade_visibility.glsl");
    return;
  }
  kernel_ = c.boolean("visibility") ? c.rayKernel("shade.glsl", {.defines = {{"FINAL_VISIBILITY", "1"}}})
                                    : c.kernel("shade.glsl");
}

void Shade::record(RecordContext& c) {
  c.launch(kernel_);
  if (split_) c.launch(rays_);
}

}  // namespace weir::passes
