#include "view/panels/scene_panel.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace weir::view {

SceneModel describe(const render::Stage& stage, const render::StageOptions& options, uint64_t deviceBytes) {
  SceneModel model;
  const scene::Scene& scene = stage.scene;
  const scene::PreparedScene& prepared = stage.prepared;
  const auto fact = [&](const char* label, std::string value) { model.facts.emplace_back(label, std::move(value)); };
  uint64_t triangles = 0;
  for (const scene::PreparedInstance& instance : prepared.instances) {
    const scene::TriangleRange& range = prepared.ranges[instance.range];
    triangles += range.opaque + range.masked;
  }
  fact("file", std::filesystem::path(options.scene).filename().string());
  fact("triangles", fmt::format("{}", triangles));
  fact("instances", fmt::format("{} ({} meshes)", prepared.instances.size(), scene.meshes.size()));
  fact("materials", fmt::format("{}", scene.materials.size()));
  fact("textures", fmt::format("{} of {} images", prepared.textures.size(), scene.images.size()));
  size_t points = 0, spots = 0, directional = 0;
  for (const scene::PunctualLight& light : scene.lights) {
    points += light.kind == scene::LightKind::Point ? 1 : 0;
    spots += light.kind == scene::LightKind::Spot ? 1 : 0;
    directional += light.kind == scene::LightKind::Directional ? 1 : 0;
  }
  std::string lights;
  const auto part = [&lights](size_t count, const char* what) {
    if (count > 0) lights += fmt::format("{}{} {}", lights.empty() ? "" : ", ", count, what);
  };
  part(points, "points");
  part(spots, "spots");
  part(directional, "directional");
  part(prepared.triangleLights, "triangles");
  part(prepared.traits.environment ? 1 : 0, "environment");
  fact("lights", lights.empty() ? "none" : lights);
  if (!options.environment.empty()) fact("sky", std::filesystem::path(options.environment).filename().string());
  const glm::vec3 size = prepared.bounds.empty ? glm::vec3(0.0f) : prepared.bounds.high - prepared.bounds.low;
  fact("size", fmt::format("{:.3g} x {:.3g} x {:.3g} m", size.x, size.y, size.z));
  fact("on device", fmt::format("{:.1f} MB", static_cast<double>(deviceBytes) * 1e-6));
  fact("shading", stage.shadingLabel);
  for (const scene::Camera& camera : scene.cameras) model.cameras.push_back(camera.name);
  for (const scene::Clip& clip : scene.clips) model.clips.push_back(clip.name);
  model.warnings = scene.warnings;
  model.hasOwnLights = options.lights == 0 && !prepared.lights.empty();
  return model;
}

}  // namespace weir::view
