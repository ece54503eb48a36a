// Packs materials and the textures that they read. Internal to scene/prepare.
#pragma once

#include <weir/scene/prepared.h>

namespace weir::scene {

/// Fills materials, speculars and textures of `prepared`, and the traits that follow from them. Slots whose image is
/// not decoded count as empty.
void prepareMaterials(const Scene& scene, PreparedScene& prepared);

}  // namespace weir::scene
