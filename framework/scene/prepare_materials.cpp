#include <weir/scene/prepare_materials.h>
#include <weir/scene/specular_albedo.h>

#include <algorithm>

namespace weir::scene {
namespace {

bool dependsOnLevel(const PreparedTexture& t, const Image& image) {
  return (t.mipFilter != MipFilter::None && std::max(image.width, image.height) > 1) || t.minFilter != t.magFilter;
}

/// Index of the texture as a slot uses it; equal uses share one.
int32_t prepareTexture(const Scene& scene, const TextureSlot& slot, MipContent content, PreparedScene& prepared) {
  if (!slot) return -1;
  const Texture& from = scene.textures[slot.texture];
  if (from.image < 0 || scene.images[from.image].rgba.empty()) return -1;
  if (from.mipFilter == MipFilter::None) content.weightByAlpha = false;  // there is nothing to average
  const PreparedTexture texture{from.image,     content,        from.wrapS,     from.wrapT,
                                from.magFilter, from.minFilter, from.mipFilter, slot.uvSet == 1 ? 1u : 0u,
                                slot.transform};
  prepared.traits.uvSets |= texture.uvSet == 1;
  prepared.traits.uvTransforms |= !texture.transform.isIdentity();
  prepared.traits.mipmaps |= dependsOnLevel(texture, scene.images[from.image]);
  const auto found = std::find(prepared.textures.begin(), prepared.textures.end(), texture);
  if (found != prepared.textures.end()) return static_cast<int32_t>(found - prepared.textures.begin());
  prepared.textures.push_back(texture);
  return static_cast<int32_t>(prepared.textures.size() - 1);
}

uint32_t flagsOf(const Material& from) {
  return (from.alphaMode == AlphaMode::Mask ? kMaterialMask : 0u) |
         (from.alphaMode == AlphaMode::Blend ? kMaterialBlend : 0u) | (from.doubleSided ? kMaterialDoubleSided : 0u) |
         (from.isEmissive() ? kMaterialEmissive : 0u) |
         (from.model == MaterialModel::SpecularGlossiness ? kMaterialSpecularGlossiness : 0u) |
         (from.model == MaterialModel::Unlit ? kMaterialUnlit : 0u);
}

PackedMaterial packMaterial(const Scene& scene, const Material& from, PreparedScene& prepared) {
  PackedMaterial m;
  m.baseColor = from.baseColor;
  m.emission = from.emission;
  m.alphaCutoff = from.alphaCutoff;
  m.metallic = from.metallic;
  m.roughness = from.model == MaterialModel::SpecularGlossiness ? from.glossiness : from.roughness;
  m.normalScale = from.normalScale;
  m.flags = flagsOf(from);
  const MipContent color{true, false}, data{false, false};
  m.baseColorTexture =
      prepareTexture(scene, from.baseColorTexture, {true, from.alphaMode != AlphaMode::Opaque}, prepared);
  m.metallicRoughnessTexture = prepareTexture(scene, from.metallicRoughnessTexture, data, prepared);
  m.normalTexture = prepareTexture(scene, from.normalTexture, data, prepared);
  m.emissiveTexture = from.isEmissive() ? prepareTexture(scene, from.emissiveTexture, color, prepared) : -1;
  return m;
}

PackedSpecular packSpecular(const Scene& scene, const Material& from, PreparedScene& prepared) {
  PackedSpecular s;
  if (from.model == MaterialModel::Unlit) return s;
  s.f0 = from.specularColor;
  if (from.model == MaterialModel::MetallicRoughness) {
    const float root = (from.ior - 1.0f) / (from.ior + 1.0f);
    s.f0 *= root * root;
    s.weight = from.specular;
  }
  s.colorTexture = prepareTexture(scene, from.specularColorTexture, {true, false}, prepared);
  s.weightTexture = prepareTexture(scene, from.specularTexture, {false, false}, prepared);
  return s;
}

/// Whether a metallic-roughness material is more than glTF 2.0's own.
bool hasOwnSpecular(const Material& m) {
  return m.model == MaterialModel::MetallicRoughness &&
         (m.ior != 1.5f || m.specular != 1.0f || m.specularColor != glm::vec3(1.0f) || m.specularTexture ||
          m.specularColorTexture);
}

/// Whether any light at all can meet its specular lobe head on: with F0 = 0 compensation changes nothing.
bool hasF0(const Material& m) {
  if (m.model == MaterialModel::Unlit) return false;
  const bool color = m.specularColor != glm::vec3(0.0f);
  if (m.model == MaterialModel::SpecularGlossiness) return color;
  return m.metallic > 0.0f || (m.ior != 1.0f && m.specular > 0.0f && color);
}

bool usesDefaultMaterial(const Scene& scene) {
  return std::ranges::any_of(scene.meshes, [](const Mesh& mesh) {
    return std::ranges::any_of(mesh.primitives, [](const Primitive& p) { return p.material < 0; });
  });
}

}  // namespace

void prepareMaterials(const Scene& scene, PreparedScene& prepared) {
  SceneTraits& traits = prepared.traits;
  for (const Material& m : scene.materials) {
    traits.specularGlossiness |= m.model == MaterialModel::SpecularGlossiness;
    traits.dielectricSpecular |= hasOwnSpecular(m);
    traits.blend |= m.alphaMode == AlphaMode::Blend;
    traits.unlit |= m.model == MaterialModel::Unlit;
    traits.f90 |= m.model == MaterialModel::Unlit || (hasOwnSpecular(m) && (m.specular != 1.0f || m.specularTexture));
    prepared.materials.push_back(packMaterial(scene, m, prepared));
  }
  prepared.materials.push_back(packMaterial(scene, Material{}, prepared));
  traits.energyCompensation =
      scene.energyCompensation && (usesDefaultMaterial(scene) || std::ranges::any_of(scene.materials, hasF0));
  if (traits.energyCompensation) prepared.specularAlbedo = specularAlbedoTable();
  if (!traits.specularGlossiness && !traits.dielectricSpecular) return;
  for (const Material& m : scene.materials) prepared.speculars.push_back(packSpecular(scene, m, prepared));
  prepared.speculars.push_back(packSpecular(scene, Material{}, prepared));
}

}  // namespace weir::scene
