// Materials, textures and samplers of a glTF file.
#include <weir/scene/gltf_import.h>

#include <algorithm>

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

void importTextures(GltfImport& import) {
  const auto& json = import.file.json();
  if (const auto images = json.find("images"); images != json.end())
    for (const auto& image : *images) {
      Image empty;
      empty.name = image.value("name", image.contains("uri") ? image["uri"].get<std::string>().substr(0, 200) : "");
      if (empty.name.starts_with("data:")) empty.name.clear();
      import.scene.images.push_back(std::move(empty));
    }
  for (const auto& texture : import.model.textures) {
    Texture t;
    t.image = texture.source;  // -1 when only an extension names an image
    if (texture.sampler >= 0) {
      const auto& sampler = import.model.samplers[texture.sampler];
      t.wrapS = wrapOf(import, sampler.wrapS);
      t.wrapT = wrapOf(import, sampler.wrapT);
      t.magFilter = filterOf(sampler.magFilter);
      t.minFilter = filterOf(sampler.minFilter);
    }
    import.scene.textures.push_back(t);
  }
}

template <class Info>
TextureSlot slotOf(GltfImport& import, const Info& info) {
  if (info.index < 0) return {};
  if (import.scene.textures[info.index].image < 0) {
    import.warn("a texture has no PNG or JPEG source and is left out");
    return {};
  }
  return {info.index, info.texCoord};
}

float unit(GltfImport& import, double value, const char* what) {
  if (value < 0.0 || value > 1.0) import.warn(std::string(what) + " outside of 0 to 1 is clamped");
  return static_cast<float>(std::clamp(value, 0.0, 1.0));
}

/// A vertex carries one pair of texture coordinates: a material's textures must agree on the set.
int settleUvSet(GltfImport& import, Material& material) {
  TextureSlot* slots[] = {&material.baseColorTexture, &material.emissiveTexture, &material.normalTexture,
                          &material.metallicRoughnessTexture};
  int set = -1;
  for (TextureSlot* slot : slots) {
    if (!*slot) continue;
    if (set < 0) set = slot->uvSet;
    if (slot->uvSet == set) continue;
    import.warn("material \"" + material.name +
                "\" reads two sets of texture coordinates; the textures of the second are left out");
    *slot = {};
  }
  return std::max(set, 0);
}

float emissiveStrength(const tinygltf::Material& material) {
  const auto found = material.extensions.find("KHR_materials_emissive_strength");
  if (found == material.extensions.end() || !found->second.Has("emissiveStrength")) return 1.0f;
  return static_cast<float>(found->second.Get("emissiveStrength").GetNumberAsDouble());
}

}  // namespace

void importMaterials(GltfImport& import) {
  importTextures(import);
  for (const auto& from : import.model.materials) {
    Material m;
    m.name = from.name;
    const auto& pbr = from.pbrMetallicRoughness;
    for (int i = 0; i < 4 && i < static_cast<int>(pbr.baseColorFactor.size()); ++i)
      m.baseColor[i] = unit(import, pbr.baseColorFactor[i], "baseColorFactor");
    m.metallic = unit(import, pbr.metallicFactor, "metallicFactor");
    m.roughness = unit(import, pbr.roughnessFactor, "roughnessFactor");
    const float strength = emissiveStrength(from);
    for (int i = 0; i < 3 && i < static_cast<int>(from.emissiveFactor.size()); ++i)
      m.emission[i] = static_cast<float>(from.emissiveFactor[i]) * strength;
    if (m.emission.x < 0.0f || m.emission.y < 0.0f || m.emission.z < 0.0f) {
      import.warn("negative emission is taken as none");
      m.emission = glm::max(m.emission, glm::vec3(0.0f));
    }
    for (int i = 0; i < 3; ++i)
      if (!std::isfinite(m.emission[i]))
        import.file.fail("/materials", "\"" + m.name + "\" has an emission beyond all numbers");
    m.normalScale = static_cast<float>(from.normalTexture.scale);
    m.baseColorTexture = slotOf(import, pbr.baseColorTexture);
    m.metallicRoughnessTexture = slotOf(import, pbr.metallicRoughnessTexture);
    m.normalTexture = slotOf(import, from.normalTexture);
    m.emissiveTexture = slotOf(import, from.emissiveTexture);
    if (from.alphaMode == "MASK")
      m.alphaMode = AlphaMode::Mask;
    else if (from.alphaMode == "BLEND")
      m.alphaMode = AlphaMode::Blend;
    else if (from.alphaMode != "OPAQUE")
      import.warn("unknown alphaMode \"" + from.alphaMode + "\" is taken as OPAQUE");
    m.alphaCutoff = static_cast<float>(from.alphaCutoff);
    m.doubleSided = from.doubleSided;
    import.materialUvSet.push_back(settleUvSet(import, m));
    import.scene.materials.push_back(std::move(m));
  }
}

}  // namespace weir::scene
