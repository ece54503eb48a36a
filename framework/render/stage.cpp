#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/core/text.h>
#include <weir/render/picture_header.h>
#include <weir/render/stage.h>
#include <weir/scene/import.h>

#include <algorithm>
#include <chrono>
#include <cmath>
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

std::optional<Playback> choosePlayback(const StageOptions& options, const scene::Scene& scene) {
  if (!options.animate) {
    if (!options.clip.empty()) throw InputError("--clip needs --animate");
    return std::nullopt;
  }
  if (!(options.timeStep >= 0.0) || !std::isfinite(options.timeStep))
    throw InputError(fmt::format("--time-step {}: must be 0 or more seconds", options.timeStep));
  if (!(options.time >= 0.0) || !std::isfinite(options.time))
    throw InputError(fmt::format("--time {}: must be 0 or more seconds", options.time));
  const auto clip = static_cast<size_t>(&scene::chooseClip(scene, options.clip) - scene.clips.data());
  return Playback{clip, options.time, options.timeStep};
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
  s.scene.energyCompensation = options.energyCompensation;
  s.playback = choosePlayback(options, s.scene);
  const auto prepare = std::chrono::steady_clock::now();
  const scene::Clip* clip = s.playback ? &s.scene.clips[s.playback->clip] : nullptr;
  s.prepared = scene::prepareScene(s.scene, {}, clip);
  s.prepareSeconds = secondsSince(prepare);
  s.shadingLabel = s.prepared.traits.energyCompensation ? "glTF 2.0 with energy compensation" : "glTF 2.0";
  std::optional<scene::Bounds> bounds;
  if (clip != nullptr && options.camera.empty() && s.scene.cameras.empty())
    bounds = scene::clipBounds(s.scene, s.prepared, *clip);
  s.camera = scene::chooseCamera(s.scene, options.camera, aspect, bounds ? &*bounds : nullptr);
  s.cameraLabel = cameraLabel(s.camera);
  return s;
}

Player::Player(const Stage& stage) : stage_(stage) {
  if (stage.prepared.traits.animated) states_.emplace(stage.scene, stage.prepared);
}

execute::FrameInput Player::frame(uint32_t number, uint32_t seed) {
  return frameAt(stage_.playback ? stage_.playback->time(number) : 0.0, number, seed);
}

execute::FrameInput Player::frameAt(double seconds, uint32_t number, uint32_t seed) {
  execute::FrameInput input;
  input.camera = stage_.camera;
  input.index = number;
  input.seed = seed;
  if (!stage_.playback) return input;
  const scene::Clip& clip = stage_.scene.clips[stage_.playback->clip];
  const scene::Pose pose = scene::evaluate(stage_.scene, clip, scene::wrapped(clip, seconds));
  input.camera = scene::posed(stage_.camera, pose);
  if (states_) {
    state_ = states_->at(pose, false);
    input.state = &state_;
  }
  return input;
}

void requireFrameNumbers(uint32_t first, const char* option, uint32_t count) {
  if (uint64_t{first} + count <= uint64_t{1} << 32) return;
  throw InputError(
      fmt::format("--first-frame {} with {} {}: frames are numbered up to {}", first, option, count, UINT32_MAX));
}

std::string animationLabel(const Stage& stage, uint64_t first, uint64_t last) {
  if (!stage.playback) return "";
  const scene::Clip& clip = stage.scene.clips[stage.playback->clip];
  const auto at = [&](uint64_t frame) {
    return fmt::format("{:.6g}", scene::wrapped(clip, stage.playback->time(frame)));
  };
  if (at(first) == at(last)) return fmt::format("{} at {} s", clip.name, at(last));
  return fmt::format("{} from {} to {} s", clip.name, at(first), at(last));
}

}  // namespace weir::render
