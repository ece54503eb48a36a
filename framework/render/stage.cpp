#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/core/text.h>
#include <weir/render/stage.h>
#include <weir/scene/import.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>

namespace weir::render {
namespace {

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

uint64_t fileHash(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<char> block(1 << 20);
  uint64_t hash = fnv1a("");
  while (file) {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    hash = fnv1a(std::string_view(block.data(), static_cast<size_t>(file.gcount())), hash);
  }
  return hash;
}

bool hasLights(const scene::Scene& scene) {
  if (!scene.lights.empty()) return true;
  return std::ranges::any_of(scene.instances, [&](const scene::Instance& i) {
    return std::ranges::any_of(scene.meshes[i.mesh].primitives, [&](const scene::Primitive& p) {
      return p.material >= 0 && scene.materials[p.material].isEmissive();
    });
  });
}

}  // namespace

Stage makeStage(const StageOptions& options, float aspect) {
  Stage s;
  s.scene = scene::importGltf(options.scene, {}, &s.importTimes);
  const auto hash = std::chrono::steady_clock::now();
  s.sceneLabel =
      fmt::format("{} {:016x}", std::filesystem::path(options.scene).filename().string(), fileHash(options.scene));
  s.importTimes.read += secondsSince(hash);
  s.lightsLabel = "scene";
  if (options.replaceLights) {
    if (options.lights == 0) throw InputError("--replace-lights needs --lights N");
    s.scene.lights.clear();
    for (scene::Material& m : s.scene.materials) m.emission = glm::vec3(0.0f);
  }
  if (options.lights > 0) {
    if (hasLights(s.scene)) {
      throw InputError(
          fmt::format("--lights: {} has lights of its own; --replace-lights takes them away", options.scene));
    }
    scene::addGeneratedLights(s.scene, options.lights, options.lightSeed);
    s.lightsLabel = fmt::format("{} points, seed {}", options.lights, options.lightSeed);
  }
  s.camera = scene::chooseCamera(s.scene, options.camera, aspect);
  const scene::Camera& c = s.camera;
  s.cameraLabel = fmt::format(
      "eye {:.9g} {:.9g} {:.9g} forward {:.9g} {:.9g} {:.9g} up {:.9g} {:.9g} {:.9g} vfov {:.9g}", c.eye.x, c.eye.y,
      c.eye.z, c.forward.x, c.forward.y, c.forward.z, c.up.x, c.up.y, c.up.z, glm::degrees(c.verticalFov));
  const auto prepare = std::chrono::steady_clock::now();
  s.prepared = scene::prepareScene(s.scene);
  s.prepareSeconds = secondsSince(prepare);
  return s;
}

}  // namespace weir::render
