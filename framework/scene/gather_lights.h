// Fills PreparedScene::lights, its alias table and the environment's. Internal to scene/prepare.
#pragma once

#include <weir/scene/prepared.h>

namespace weir::scene {

/// Expects geometry, materials, textures and bounds to be ready; PreparedScene::textures index Scene::images. Lights
/// that the clip moves are kept even if they can't emit at rest, so that a light has one index while the clip plays.
void gatherLights(const Scene& scene, PreparedScene& prepared, const Clip* clip = nullptr);

/// Position, edges and area of a triangle's light, and whether it has an area at all.
bool setTriangle(GpuLight& light, const glm::vec3& p0, const glm::vec3& p1, const glm::vec3& p2);
/// Position and direction of a punctual light.
void setPunctual(GpuLight& light, const PunctualLight& from);
/// The alias table of these powers, and into each light the probability that the finished table gives it. Where no
/// light has any power, all are alike.
std::vector<AliasCell> buildLightTable(const std::vector<double>& power, std::vector<GpuLight>& lights);

/// Another place, colour or direction for a punctual light of a scene that is prepared: in Scene::lights, and in the
/// lights and the table made of them, whose numbers stay. InputError for a light that was dark or is to be dark, or
/// that changes its kind or gets a range where none of the scene's had a shape.
void setLight(Scene& scene, PreparedScene& prepared, size_t index, const PunctualLight& light);

}  // namespace weir::scene
