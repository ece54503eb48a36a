#include "common/layouts.h"
#include "restir_di/restir_di.h"

namespace weir::passes {

void VisibilityCache::describe(PassDescription& d) {
  d.doc("Remembers which lights were seen from each tile of 16 x 16 pixels, for passes that then prefer such");
  d.input("tested", perPixel<Reservoir>()).anyCount().doc("Reservoirs whose samples shadow rays have tested");
  d.input("more", perPixel<Reservoir>()).anyCount().optional().doc("More of them");
  d.input("history", visibilityTiles()).doc("The visibility port, @previous");
  d.output("visibility", visibilityTiles()).doc("512 cells a tile, one a light where there are no more");
  d.param("frames", 16.0f).range(1, 1024).unit("frames").doc("How long what was found counts");
  d.param("least", 0.1f).range(0.01, 1).doc("Guess for a light that was always hidden; 1: no preferences");
  d.needs(Need::SceneLights);
}

void VisibilityCache::prepare(PrepareContext& c) {
  kernel_ = c.kernel("learn_visibility.glsl", {.group = {.side = getenv("WEIR_TILE") ? uint32_t(atoi(getenv("WEIR_TILE"))) : 16u, .whole = true}});
}

void VisibilityCache::record(RecordContext& c) {
  c.launch(kernel_);
}

}  // namespace weir::passes
