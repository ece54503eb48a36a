// The one place where tinygltf is compiled.
// tinygltf 2.7 trusts its input in many places (it reads outside of short GLBs, looks for files in the working folder,
// recurses into extras): so it is given checked JSON without bytes, paths, extras, skins and animations.
#include <fstream>  // tinygltf forgets it when it is compiled without its own file access
#define TINYGLTF_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wshadow"
#include <weir/scene/gltf_import.h>
#pragma GCC diagnostic pop

#include <weir/core/error.h>

namespace weir::scene {
namespace {

void eraseExtras(nlohmann::json& value) {  // GltfFile bounds the depth
  if (value.is_object()) value.erase("extras");
  for (auto& child : value)
    if (child.is_structured()) eraseExtras(child);
}

}  // namespace

tinygltf::Model parseStructure(const GltfFile& file) {
  nlohmann::json json = file.json();
  for (const char* key : {"buffers", "images", "animations", "skins"}) json.erase(key);
  if (const auto meshes = json.find("meshes"); meshes != json.end())
    for (auto& mesh : *meshes)
      for (auto& primitive : mesh.at("primitives")) {
        primitive.erase("targets");
        // It refuses indices without a buffer view, as compressed and sparse ones are; they are put back below.
        primitive.erase("indices");
      }
  eraseExtras(json);

  tinygltf::Model model;
  try {
    const std::string text = json.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
    tinygltf::TinyGLTF loader;
    std::string error, warning;
    if (!loader.LoadASCIIFromString(&model, &error, &warning, text.c_str(), static_cast<unsigned>(text.size()), ""))
      file.fail("", error.empty() ? "not understood" : error.substr(0, error.find('\n')));
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& e) {
    file.fail("", e.what());
  }
  // What tinygltf leaves out would shift the indices that the schema check has verified.
  const auto same = [&](const char* key, size_t size) {
    const auto array = json.find(key);
    if (size != (array == json.end() ? 0 : array->size())) file.fail(std::string("/") + key, "not understood");
  };
  same("accessors", model.accessors.size());
  same("bufferViews", model.bufferViews.size());
  same("cameras", model.cameras.size());
  same("materials", model.materials.size());
  same("meshes", model.meshes.size());
  same("nodes", model.nodes.size());
  same("samplers", model.samplers.size());
  same("scenes", model.scenes.size());
  same("textures", model.textures.size());
  for (size_t i = 0; i < model.meshes.size(); ++i) {
    const auto& primitives = file.json()["meshes"][i]["primitives"];
    if (model.meshes[i].primitives.size() != primitives.size())
      file.fail("/meshes/" + std::to_string(i), "not understood");
    for (size_t p = 0; p < primitives.size(); ++p)
      model.meshes[i].primitives[p].indices = primitives[p].value("indices", -1);
  }
  return model;
}

}  // namespace weir::scene
