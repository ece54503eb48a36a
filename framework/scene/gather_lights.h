// Fills PreparedScene::lights, its alias table and the environment's. Internal to scene/prepare.
#pragma once

#include <weir/scene/prepared.h>

namespace weir::scene {

/// Expects range 0, materials, textures and bounds to be ready; PreparedScene::textures index Scene::images.
void gatherLights(const Scene& scene, PreparedScene& prepared);

}  // namespace weir::scene
