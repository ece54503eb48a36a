// Materials by glTF 2.0, section 3.9, and the extensions' texts.
#include <map>
#include <tuple>

#include "model.h"

namespace weir::oracle {
namespace {

class Materials {
 public:
  Materials(const Document& document, Model& model) : document_(document), model_(model) {}

  Material materialOf(const Json& from) {
    Material m;
    m.doubleSided = from.value("doubleSided", false);
    const std::string mode = from.value("alphaMode", "OPAQUE");
    if (mode != "OPAQUE") m.alpha = mode == "MASK" ? Alpha::Mask : Alpha::Blend;
    weighted_ = m.alpha != Alpha::Opaque;
    m.cutoff = from.value("alphaCutoff", 0.5);
    const Json extensions = from.value("extensions", Json::object());
    for (const auto& [name, _] : extensions.items())
      if (!name.starts_with("KHR_materials_")) document_.fail("materials", "the oracle doesn't know " + name);

    const Json pbr = from.value("pbrMetallicRoughness", Json::object());
    m.baseColor = vec4Of(pbr, "baseColorFactor");
    m.metallic = pbr.value("metallicFactor", 1.0);
    m.roughness = pbr.value("roughnessFactor", 1.0);
    if (extensions.contains("KHR_materials_pbrSpecularGlossiness")) {
      const Json& e = extensions["KHR_materials_pbrSpecularGlossiness"];
      m.glossy = true;
      m.baseColor = vec4Of(e, "diffuseFactor");
      m.specular = vec3Of(e, "specularFactor", 1.0);
      m.roughness = e.value("glossinessFactor", 1.0);  // as it is: glossiness
      m.baseTexture = slot(e, "diffuseTexture", true);
      m.roughnessTexture = slot(e, "specularGlossinessTexture", true, false);
    } else {
      m.baseTexture = slot(pbr, "baseColorTexture", true);
      m.roughnessTexture = slot(pbr, "metallicRoughnessTexture", false, false);
    }
    m.normalTexture = slot(from, "normalTexture", false, false);
    if (from.contains("normalTexture")) m.normalScale = from["normalTexture"].value("scale", 1.0);
    m.emissionTexture = slot(from, "emissiveTexture", true, false);
    m.emission = vec3Of(from, "emissiveFactor", 0.0);
    if (extensions.contains("KHR_materials_emissive_strength"))
      m.emission *= extensions["KHR_materials_emissive_strength"].value("emissiveStrength", 1.0);
    if (extensions.contains("KHR_materials_ior")) {
      const double n = extensions["KHR_materials_ior"].value("ior", 1.5);
      m.dielectricF0 = n == 0 ? 1.0 : (n - 1) * (n - 1) / ((n + 1) * (n + 1));
    }
    if (extensions.contains("KHR_materials_specular")) {
      const Json& e = extensions["KHR_materials_specular"];
      m.specularWeight = e.value("specularFactor", 1.0);
      m.specular = vec3Of(e, "specularColorFactor", 1.0);
      m.specularTexture = slot(e, "specularTexture", false, false);
      m.specularColorTexture = slot(e, "specularColorTexture", true, false);
    }
    m.unlit = extensions.contains("KHR_materials_unlit");
    return m;
  }

 private:
  static glm::dvec4 vec4Of(const Json& j, const char* key) {
    const std::vector<double> v = j.value(key, std::vector<double>{1, 1, 1, 1});
    return {v.at(0), v.at(1), v.at(2), v.at(3)};
  }
  static glm::dvec3 vec3Of(const Json& j, const char* key, double fallback) {
    const std::vector<double> v = j.value(key, std::vector<double>{fallback, fallback, fallback});
    return {v.at(0), v.at(1), v.at(2)};
  }

  static Wrap wrapOf(int code) { return code == 33071 ? Wrap::Clamp : code == 33648 ? Wrap::Mirror : Wrap::Repeat; }

  Slot slot(const Json& parent, const char* key, bool colour, bool hasCoverage = true) {
    if (!parent.contains(key)) return {};
    const Json& info = parent[key];
    Slot s;
    s.set = info.value("texCoord", 0);
    const Json extensions = info.value("extensions", Json::object());
    for (const auto& [name, e] : extensions.items()) {
      if (name != "KHR_texture_transform") document_.fail(key, "the oracle doesn't know " + name);
      if (e.value("rotation", 0.0) != 0.0) document_.fail(key, "the oracle doesn't rotate textures");
      const std::vector<double> offset = e.value("offset", std::vector<double>{0, 0});
      const std::vector<double> scale = e.value("scale", std::vector<double>{1, 1});
      s.offset = {offset.at(0), offset.at(1)};
      s.scale = {scale.at(0), scale.at(1)};
      s.set = e.value("texCoord", s.set);
    }
    if (s.set < 0 || s.set > 1) document_.fail(key, "the oracle knows two sets of coordinates");
    s.texture = texture(info.at("index"), colour, hasCoverage && weighted_);
    return s;
  }

  const Texture* texture(size_t index, bool colour, bool weighted) {
    const Texture*& known = textures_[{index, colour, weighted}];
    if (known) return known;
    const Json& from = document_.json().at("textures").at(index);
    Sampling sampling;
    if (from.contains("sampler")) {
      const Json& s = document_.json().at("samplers").at(from["sampler"].get<size_t>());
      sampling.s = wrapOf(s.value("wrapS", 10497));
      sampling.t = wrapOf(s.value("wrapT", 10497));
      sampling.nearest = s.value("magFilter", 9729) == 9728;
      const int minified = s.value("minFilter", 9987);
      sampling.nearestMinified = minified == 9728 || minified == 9984 || minified == 9986;
      sampling.levels = minified != 9728 && minified != 9729;
      sampling.nearestLevel = minified == 9984 || minified == 9985;
    }
    model_.textures.push_back(std::make_unique<Texture>(image(from.at("source")), sampling, colour, weighted));
    return known = model_.textures.back().get();
  }

  const Image& image(size_t index) {
    const Image*& known = images_[index];
    if (known == nullptr) {
      const std::string name = document_.path() + ": images/" + std::to_string(index);
      model_.images.push_back(std::make_unique<Image>(decodeImage(document_.imageBytes(index), name)));
      known = model_.images.back().get();
    }
    return *known;
  }

  const Document& document_;
  Model& model_;
  bool weighted_ = false;
  std::map<size_t, const Image*> images_;
  std::map<std::tuple<size_t, bool, bool>, const Texture*> textures_;
};

}  // namespace

/// Number 0 is the default material; the file's follow.
std::vector<Material> loadMaterials(const Document& document, Model& model) {
  Materials loader(document, model);
  std::vector<Material> materials = {Material{}};
  for (const Json& m : document.json().value("materials", Json::array())) materials.push_back(loader.materialOf(m));
  return materials;
}

}  // namespace weir::oracle
