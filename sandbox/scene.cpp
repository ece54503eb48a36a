// `weir scene FILE [--json]`: what a scene holds.
#include "commands.h"

#include <fmt/core.h>
#include <weir/scene/import.h>
#include <weir/scene/prepared.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

namespace {

using nlohmann::ordered_json;
using namespace weir::scene;

ordered_json vec(const glm::vec3& v) {
  return {v.x, v.y, v.z};
}

/// What the scene holds in memory once it is arranged. Devices need about the same again, and acceleration structures:
/// `weir render --stats` says how much.
ordered_json memory(const Scene& scene, const PreparedScene& prepared) {
  const auto bytes = [](const auto&... arrays) { return (uint64_t{0} + ... + (arrays.size() * sizeof(arrays[0]))); };
  uint64_t images = 0;
  for (const Image& image : scene.images) images += image.rgba.size();
  return {{"geometry_bytes",
           bytes(prepared.positions, prepared.vertices, prepared.colors, prepared.uvs1, prepared.triangles)},
          {"image_bytes", images},
          {"light_bytes", bytes(prepared.lights, prepared.aliasTable)}};
}

ordered_json describe(const Scene& scene, const PreparedScene& prepared) {
  const SceneSummary s = summarize(scene);
  const SceneTraits& t = prepared.traits;
  ordered_json cameras = ordered_json::array();
  for (const Camera& camera : scene.cameras)
    cameras.push_back({{"name", camera.name},
                       {"eye", vec(camera.eye)},
                       {"forward", vec(camera.forward)},
                       {"vertical_fov_degrees", glm::degrees(camera.verticalFov)}});
  ordered_json clips = ordered_json::array();
  for (const Clip& clip : scene.clips)
    clips.push_back({{"name", clip.name}, {"seconds", clip.duration}, {"channels", clip.channels.size()}});
  ordered_json j;
  j["scene"] = scene.path;
  j["triangles"] = {{"stored", s.storedTriangles},
                    {"instanced", s.instancedTriangles},
                    {"emissive", s.emissiveTriangles},
                    {"dropped", prepared.droppedTriangles}};
  j["vertices"] = s.vertices;
  j["meshes"] = s.meshes;
  j["primitives"] = s.primitives;
  j["colored_primitives"] = s.coloredPrimitives;
  j["instances"] = s.instances;
  j["materials"] = {{"all", s.materials},
                    {"masked", s.maskedMaterials},
                    {"blended", s.blendMaterials},
                    {"specular_glossiness", s.glossyMaterials},
                    {"unlit", s.unlitMaterials}};
  j["lights"] = {{"point", s.pointLights},
                 {"spot", s.spotLights},
                 {"directional", s.directionalLights},
                 {"triangles", prepared.triangleLights},
                 {"sampled", prepared.lights.size()}};
  j["textures"] = {
      {"all", s.textures}, {"images", s.images}, {"used", prepared.textures.size()}, {"transformed", s.uvTransforms}};
  j["memory"] = memory(scene, prepared);
  j["animations"] = s.animations;
  j["clips"] = std::move(clips);
  j["skins"] = scene.skins.size();
  if (s.bounds.empty)
    j["bounds"] = nullptr;
  else
    j["bounds"] = {{"low", vec(s.bounds.low)}, {"high", vec(s.bounds.high)}, {"radius", s.bounds.radius()}};
  j["cameras"] = std::move(cameras);
  j["traits"] = {{"alpha_test", s.maskedMaterials + s.blendMaterials > 0},
                 {"textures", !prepared.textures.empty()},
                 {"emissive_triangles", prepared.triangleLights > 0},
                 {"delta_lights", prepared.lights.size() > prepared.triangleLights},
                 {"shared_geometry", prepared.ranges.size() > 2},  // the first two are the merged geometry
                 {"textured_lights", t.texturedLights},
                 {"alpha_lights", t.alphaLights},
                 {"vertex_colors", t.vertexColors},
                 {"uv_sets", t.uvSets},
                 {"uv_transforms", t.uvTransforms},
                 {"mipmaps", t.mipmaps},
                 {"specular_glossiness", t.specularGlossiness},
                 {"dielectric_specular", t.dielectricSpecular},
                 {"blend", t.blend},
                 {"unlit", t.unlit},
                 {"f90", t.f90}};
  j["warnings"] = scene.warnings;
  return j;
}

/// One line a property, names padded; the same content as the JSON.
void printText(const ordered_json& j) {
  for (const auto& [key, value] : j.items()) {
    if (key == "warnings" || key == "cameras" || key == "clips") {
      fmt::print("{:<11} {}\n", key, value.empty() ? "none" : "");
      for (const auto& entry : value) fmt::print("  {}\n", entry.is_string() ? entry.get<std::string>() : entry.dump());
    } else if (value.is_object()) {
      std::string line;
      for (const auto& [name, part] : value.items())
        line += fmt::format("{}{} {}", line.empty() ? "" : ", ", name, part.dump());
      fmt::print("{:<11} {}\n", key, line);
    } else {
      fmt::print("{:<11} {}\n", key, value.is_string() ? value.get<std::string>() : value.dump());
    }
  }
}

}  // namespace

void addSceneCommand(CLI::App& app) {
  struct Options {
    std::string file;
    bool json = false;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("scene", "Say what a scene holds: triangles, materials, lights, cameras, traits");
  command->add_option("FILE", options->file, "A .gltf or .glb file")->required();
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options] {
    const Scene scene = importGltf(options->file);
    const ordered_json j = describe(scene, prepareScene(scene));
    if (options->json)
      fmt::print("{}\n", j.dump(2, ' ', false, ordered_json::error_handler_t::replace));
    else
      printText(j);
  });
}
