// Materials, textures and samplers of a glTF file.
#include <weir/scene/gltf_import.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace weir::scene {
namespace {

Wrap wrapOf(GltfImport& import, int value) {
  switch (value) {
    case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
      return Wrap::ClampToEdge;
    case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
      return Wrap::MirroredRepeat;
    case TINYGLTF_TEXTURE_WRAP_REPEAT:
      return Wrap::Repeat;
  }
  import.warn("a sampler has an unknown wrap mode; repeat is used");
  return Wrap::Repeat;
}

Filter filterOf(int value) {
  return value == TINYGLTF_TEXTURE_FILTER_NEAREST || value == TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_NEAREST ||
                 value == TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_LINEAR
             ? Filter::Nearest
             : Filter::Linear;
}

MipFilter mipFilterOf(int value) {
  switch (value) {
    case TINYGLTF_TEXTURE_FILTER_NEAREST:
    case TINYGLTF_TEXTURE_FILTER_LINEAR:
      return MipFilter::None;
    case TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_NEAREST:
    case TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_NEAREST:
      return MipFilter::Nearest;
  }
  return MipFilter::Linear;
}

void importImageNames(GltfImport& import) {
  const auto& json = import.file.json();
  if (const auto images = json.find("images"); images != json.end())
    for (const auto& image : *images) {
      Image empty;
      empty.name = image.value("name", image.contains("uri") ? image["uri"].get<std::string>().substr(0, 200) : "");
      if (empty.name.starts_with("data:")) empty.name.clear();
      import.scene.images.push_back(std::move(empty));
    }
}

void importTextures(GltfImport& import) {
  for (const auto& texture : import.model.textures) {
    Texture t;
    t.image = texture.source;         // -1 when only an extension names an image
    t.mipFilter = MipFilter::Linear;  // what glTF leaves to us without a sampler
    for (const char* extension : kOtherImageFormats)
      if (texture.extensions.contains(extension))
        import.warn(std::string(extension) + " is not implemented: " +
                    (t.image >= 0 ? "the PNG or JPEG that the texture names beside it is used"
                                  : "textures that name no PNG or JPEG beside it are left out"));
    if (texture.sampler >= 0) {
      const auto& sampler = import.model.samplers[texture.sampler];
      t.wrapS = wrapOf(import, sampler.wrapS);
      t.wrapT = wrapOf(import, sampler.wrapT);
      t.magFilter = filterOf(sampler.magFilter);
      t.minFilter = filterOf(sampler.minFilter);
      t.mipFilter = mipFilterOf(sampler.minFilter);
    }
    import.scene.textures.push_back(t);
  }
}

float unit(GltfImport& import, double value, const char* what) {
  if (value < 0.0 || value > 1.0) import.warn(std::string(what) + " outside of 0 to 1 is clamped");
  return static_cast<float>(std::clamp(value, 0.0, 1.0));
}

/// A JSON number can be beyond all floats.
float orDefault(GltfImport& import, double value, float otherwise) {
  if (std::abs(value) <= std::numeric_limits<float>::max()) return static_cast<float>(value);
  import.warn("a number beyond all floats is replaced by its default");
  return otherwise;
}

/// A member that the schema has checked, or `otherwise`.
float numberOf(GltfImport& import, const nlohmann::json& object, const char* key, float otherwise) {
  return orDefault(import, object.value(key, static_cast<double>(otherwise)), otherwise);
}

const nlohmann::json* memberOf(const nlohmann::json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

const nlohmann::json* extensionOf(const nlohmann::json& object, const char* name) {
  const nlohmann::json* extensions = memberOf(object, "extensions");
  return extensions ? memberOf(*extensions, name) : nullptr;
}

/// KHR_texture_transform: scaled, then turned counter-clockwise as seen with v pointing down, then moved.
UvTransform transformOf(GltfImport& import, const nlohmann::json& from) {
  const auto pair = [&](const char* key, float otherwise) {
    const nlohmann::json* values = memberOf(from, key);
    if (!values) return glm::vec2(otherwise);
    return glm::vec2(orDefault(import, (*values)[0].get<double>(), otherwise),
                     orDefault(import, (*values)[1].get<double>(), otherwise));
  };
  const glm::vec2 scale = pair("scale", 1.0f);
  const double angle = numberOf(import, from, "rotation", 0.0f);
  const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
  UvTransform t;
  t.linear = glm::mat2(glm::vec2(c, -s) * scale.x, glm::vec2(s, c) * scale.y);
  t.offset = pair("offset", 0.0f);
  return t;
}

/// The slot `key` of an object; its uvSet is still the file's own.
TextureSlot slotOf(GltfImport& import, const nlohmann::json& owner, const char* key) {
  const nlohmann::json* info = memberOf(owner, key);
  if (!info) return {};
  TextureSlot slot{info->at("index").get<int>(), info->value("texCoord", 0), {}};
  if (import.scene.textures[slot.texture].image < 0) {
    import.warn("a texture has no PNG or JPEG source and is left out");
    return {};
  }
  if (const nlohmann::json* transform = extensionOf(*info, "KHR_texture_transform")) {
    slot.uvSet = transform->value("texCoord", slot.uvSet);
    slot.transform = transformOf(import, *transform);
  }
  return slot;
}

/// A primitive carries two sets of texture coordinates: the first two that a material's slots read. Slots are
/// renumbered to those. Returns the file's numbers, -1: none.
std::array<int, 2> settleUvSets(GltfImport& import, Material& material) {
  std::array<int, 2> sets = {-1, -1};
  for (TextureSlot* slot : material.slots()) {
    if (!*slot) continue;
    const int wanted = slot->uvSet;
    const int place = sets[0] < 0 || sets[0] == wanted ? 0 : sets[1] < 0 || sets[1] == wanted ? 1 : -1;
    if (place < 0) {
      import.warn("material \"" + material.name +
                  "\" reads more than two sets of texture coordinates; the textures of the third are left out");
      *slot = {};
      continue;
    }
    sets[place] = wanted;
    slot->uvSet = place;
  }
  if (sets[0] < 0) sets[0] = 0;
  return sets;
}

template <int N>
glm::vec<N, float> factorOf(GltfImport& import, const nlohmann::json& from, const char* key) {
  glm::vec<N, float> result(1.0f);
  if (const nlohmann::json* values = memberOf(from, key))
    for (int i = 0; i < N; ++i) result[i] = unit(import, (*values)[i].template get<double>(), key);
  return result;
}

void importSpecularGlossiness(GltfImport& import, const nlohmann::json& from, Material& m) {
  m.model = MaterialModel::SpecularGlossiness;
  m.baseColor = factorOf<4>(import, from, "diffuseFactor");
  m.specularColor = factorOf<3>(import, from, "specularFactor");
  m.glossiness = unit(import, from.value("glossinessFactor", 1.0), "glossinessFactor");
  m.baseColorTexture = slotOf(import, from, "diffuseTexture");
  m.specularColorTexture = slotOf(import, from, "specularGlossinessTexture");
}

void importSpecular(GltfImport& import, const nlohmann::json& from, Material& m) {
  m.specular = unit(import, from.value("specularFactor", 1.0), "specularFactor");
  if (const nlohmann::json* color = memberOf(from, "specularColorFactor"))
    for (int i = 0; i < 3; ++i) m.specularColor[i] = std::max(orDefault(import, (*color)[i].get<double>(), 1.0f), 0.0f);
  m.specularTexture = slotOf(import, from, "specularTexture");
  m.specularColorTexture = slotOf(import, from, "specularColorTexture");
}

void importMetallicRoughness(GltfImport& import, const nlohmann::json& material, Material& m) {
  if (const nlohmann::json* pbr = memberOf(material, "pbrMetallicRoughness")) {
    m.baseColor = factorOf<4>(import, *pbr, "baseColorFactor");
    m.metallic = unit(import, pbr->value("metallicFactor", 1.0), "metallicFactor");
    m.roughness = unit(import, pbr->value("roughnessFactor", 1.0), "roughnessFactor");
    m.baseColorTexture = slotOf(import, *pbr, "baseColorTexture");
    m.metallicRoughnessTexture = slotOf(import, *pbr, "metallicRoughnessTexture");
  }
  if (const nlohmann::json* ior = extensionOf(material, "KHR_materials_ior")) {
    m.ior = numberOf(import, *ior, "ior", 1.5f);
    // 0 is the extension's own way to say that all light is reflected at normal incidence.
    if (m.ior < 1.0f && m.ior != 0.0f) {
      import.warn("an index of refraction below 1 is taken as 1");
      m.ior = 1.0f;
    }
  }
  if (const nlohmann::json* specular = extensionOf(material, "KHR_materials_specular"))
    importSpecular(import, *specular, m);
}

void importEmission(GltfImport& import, const nlohmann::json& material, Material& m) {
  float strength = 1.0f;
  if (const nlohmann::json* from = extensionOf(material, "KHR_materials_emissive_strength"))
    strength = static_cast<float>(from->value("emissiveStrength", 1.0));
  if (const nlohmann::json* factor = memberOf(material, "emissiveFactor"))
    for (int i = 0; i < 3; ++i) m.emission[i] = static_cast<float>((*factor)[i].get<double>()) * strength;
  if (m.emission.x < 0.0f || m.emission.y < 0.0f || m.emission.z < 0.0f) {
    import.warn("negative emission is taken as none");
    m.emission = glm::max(m.emission, glm::vec3(0.0f));
  }
  for (int i = 0; i < 3; ++i)
    if (!std::isfinite(m.emission[i]))
      import.file.fail("/materials", "\"" + m.name + "\" has an emission beyond all numbers");
  m.emissiveTexture = slotOf(import, material, "emissiveTexture");
}

void importAlpha(GltfImport& import, const nlohmann::json& material, Material& m) {
  const std::string mode = material.value("alphaMode", "OPAQUE");
  if (mode == "MASK")
    m.alphaMode = AlphaMode::Mask;
  else if (mode == "BLEND")
    m.alphaMode = AlphaMode::Blend;
  else if (mode != "OPAQUE")
    import.warn("unknown alphaMode \"" + mode.substr(0, 20) + "\" is taken as OPAQUE");
  m.alphaCutoff = numberOf(import, material, "alphaCutoff", 0.5f);
  m.doubleSided = material.value("doubleSided", false);
}

Material importMaterial(GltfImport& import, const nlohmann::json& from) {
  Material m;
  m.name = from.value("name", "");
  importAlpha(import, from, m);
  const nlohmann::json* glossy = extensionOf(from, "KHR_materials_pbrSpecularGlossiness");
  if (extensionOf(from, "KHR_materials_unlit")) {
    // Whatever else the material says is for programs that don't know the extension.
    importMetallicRoughness(import, from, m);
    m.model = MaterialModel::Unlit;
    m.metallicRoughnessTexture = m.specularTexture = m.specularColorTexture = {};
    return m;
  }
  if (glossy)
    importSpecularGlossiness(import, *glossy, m);
  else
    importMetallicRoughness(import, from, m);
  if (const nlohmann::json* normal = memberOf(from, "normalTexture")) {
    m.normalTexture = slotOf(import, from, "normalTexture");
    m.normalScale = numberOf(import, *normal, "scale", 1.0f);
  }
  importEmission(import, from, m);
  return m;
}

}  // namespace

void importMaterials(GltfImport& import) {
  importImageNames(import);
  importTextures(import);
  const auto materials = import.file.json().find("materials");
  if (materials == import.file.json().end()) return;
  for (const auto& from : *materials) {
    Material m = importMaterial(import, from);
    import.materialUvSets.push_back(settleUvSets(import, m));
    import.scene.materials.push_back(std::move(m));
  }
}

}  // namespace weir::scene
