// glTF import, in order: container and JSON, schema, extensions, structure, then the parts of gltf_*.cpp.
#include <weir/core/error.h>
#include <weir/scene/gltf_import.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <string_view>
#include <utility>

namespace weir::scene {
namespace {

constexpr auto kImplemented = std::to_array<std::string_view>(
    {"EXT_meshopt_compression", "KHR_draco_mesh_compression", "KHR_lights_punctual", "KHR_materials_emissive_strength",
     "KHR_materials_ior", "KHR_materials_pbrSpecularGlossiness", "KHR_materials_specular", "KHR_materials_unlit",
     "KHR_mesh_quantization", "KHR_texture_transform"});

bool implemented(const std::string& name) {
  return std::find(kImplemented.begin(), kImplemented.end(), name) != kImplemented.end();
}

void checkAsset(const GltfFile& file) {
  const auto& asset = file.json().at("asset");
  const std::string version = asset.at("version").get<std::string>();
  if (!version.starts_with("2.")) file.fail("/asset/version", "glTF " + version.substr(0, 20) + "; only 2.0 is known");
  const std::string least = asset.value("minVersion", "2.0");
  if (least != "2.0") file.fail("/asset/minVersion", "needs glTF " + least.substr(0, 20) + "; only 2.0 is known");
}

void refuseRequiredExtensions(const GltfFile& file) {
  const auto required = file.json().find("extensionsRequired");
  if (required == file.json().end()) return;
  std::string refused;
  for (const auto& name : *required)
    if (!implemented(name.get<std::string>())) refused += (refused.empty() ? "" : ", ") + name.get<std::string>();
  if (!refused.empty()) file.fail("/extensionsRequired", "not implemented: " + refused);
}

void warnAboutExtensions(GltfImport& import) {
  const auto used = import.file.json().find("extensionsUsed");
  if (used == import.file.json().end()) return;
  // Textures say themselves what becomes of another kind of image.
  const auto saysItself = [&](const std::string& name) {
    return std::find(kOtherImageFormats.begin(), kOtherImageFormats.end(), name) != kOtherImageFormats.end() &&
           std::any_of(import.model.textures.begin(), import.model.textures.end(),
                       [&](const tinygltf::Texture& t) { return t.extensions.contains(name); });
  };
  for (const auto& name : *used)
    if (!implemented(name.get<std::string>()) && !saysItself(name.get<std::string>()))
      import.warn("extension " + name.get<std::string>() + " is not implemented and ignored");
}

}  // namespace

void GltfImport::warn(const std::string& text) {
  if (std::find(scene.warnings.begin(), scene.warnings.end(), text) != scene.warnings.end()) return;
  // A file can name as many things as it likes; a user reads so many.
  if (scene.warnings.size() < 64) scene.warnings.push_back(text);
}

void GltfImport::countValues(uint64_t count, const std::string& place) {
  animationValues += count;
  const uint64_t most = (1u << 22) + 4 * file.loadedBytes();
  if (animationValues > most)
    file.fail(place, "more than " + std::to_string(most) + " numbers of animations and morph targets");
}

Scene importGltf(const std::string& path, const ImportLimits& limits, ImportTimes* times) {
  using Clock = std::chrono::steady_clock;
  Clock::time_point last = Clock::now();
  // Seconds since the last call.
  const auto lap = [&] {
    return std::chrono::duration<double>(Clock::now() - std::exchange(last, Clock::now())).count();
  };
  ImportTimes spent;
  GltfFile file(path, limits);
  try {
    checkGltfSchema(file);
    checkAsset(file);
    refuseRequiredExtensions(file);
    Scene scene;
    scene.path = path;
    const tinygltf::Model model = parseStructure(file);
    GltfImport import{file, model, limits, scene, {}};
    warnAboutExtensions(import);
    importMaterials(import);
    spent.read = lap();
    importMeshes(import);
    importAnimation(import);
    importNodes(import);
    spent.geometry = lap();
    importImages(import);
    spent.images = lap();
    if (times) *times = spent;
    return scene;
  } catch (const InputError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw InputError(path + ": needs more memory than there is");
  } catch (const std::exception& e) {
    throw InputError(path + ": " + e.what());
  }
}

}  // namespace weir::scene
