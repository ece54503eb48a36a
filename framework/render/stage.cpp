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

/// "name 0123456789abcdef": tells files of one name apart.
std::string fileLabel(const std::string& path) {
  return fmt::format("{} {:016x}", std::filesystem::path(path).filename().string(), fileHash(path));
}

void addEnvironment(const StageOptions& options, Stage& s) {
  if (options.environment.empty()) {
    if (options.environmentScale != 1.0f || options.environmentRotation != 0.0f) {
      throw InputError("--environment-scale and --environment-rotation need --environment FILE");
    }
    return;
  }
  s.scene.environment =
      scene::readEnvironment(options.environment, options.environmentScale, options.environmentRotation);
  const scene::Environment& e = s.scene.environment;
  s.lightsLabel += ", environment " + fileLabel(options.environment);
  if (options.environmentScale != 1.0f) s.lightsLabel += fmt::format(" times {:.9g}", options.environmentScale);
  if (options.environmentRotation != 0.0f)
    s.lightsLabel += fmt::format(" turned {:.9g} degrees", options.environmentRotation);
  const auto warn = [&](const std::string& text) { s.scene.warnings.push_back(options.environment + ": " + text); };
  if (e.mended > 0) warn(fmt::format("{} texels are negative or not finite; those channels count as black", e.mended));
  if (e.width != uint64_t{2} * e.height)
    warn(fmt::format("{}x{} texels are stretched over the sphere; a whole one is twice as wide as high", e.width,
                     e.height));
  if (!e.shines()) warn("the environment is black");
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
  s.sceneLabel = fileLabel(options.scene);
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
  const auto environment = std::chrono::steady_clock::now();
  addEnvironment(options, s);
  s.environmentSeconds = secondsSince(environment);
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
