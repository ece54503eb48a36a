// A scene as plain data: what scene/import.h reads from glTF, before anything is arranged for a GPU.
// Units: metres, radians, right-handed, +Y up; candela (point, spot), lux (directional), nit (emission).
#pragma once

#include <weir/scene/animation.h>
#include <weir/scene/environment.h>

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace weir::scene {

/// Decoded texels, 8 bits a channel, RGBA, row 0 at the top. Images that no material's slot uses are not decoded: width
/// 0, no texels.
struct Image {
  std::string name;
  uint32_t width = 0, height = 0;
  std::vector<uint8_t> rgba;
};

enum class Wrap : uint8_t { Repeat, MirroredRepeat, ClampToEdge };
enum class Filter : uint8_t { Nearest, Linear };
/// What lies between the levels of a texture; None: only level 0 is read.
enum class MipFilter : uint8_t { None, Nearest, Linear };

/// An image with its sampler. Whether its colour is sRGB-encoded follows from the slot that uses it.
struct Texture {
  int image = -1;
  Wrap wrapS = Wrap::Repeat, wrapT = Wrap::Repeat;
  Filter magFilter = Filter::Linear, minFilter = Filter::Linear;
  MipFilter mipFilter = MipFilter::None;
};

/// What is done to texture coordinates before a lookup: linear · uv + offset (KHR_texture_transform multiplied out).
struct UvTransform {
  glm::mat2 linear{1.0f};
  glm::vec2 offset{0.0f};
  bool isIdentity() const { return linear == glm::mat2(1.0f) && offset == glm::vec2(0.0f); }
  glm::vec2 operator()(const glm::vec2& uv) const { return linear * uv + offset; }
  bool operator==(const UvTransform&) const = default;
};

/// A material's use of a texture; index -1: none.
struct TextureSlot {
  int texture = -1;
  int uvSet = 0;  ///< 0: Primitive::uv0, 1: uv1
  UvTransform transform;
  explicit operator bool() const { return texture >= 0; }
};

enum class AlphaMode : uint8_t { Opaque, Mask, Blend };

enum class MaterialModel : uint8_t {
  MetallicRoughness,   ///< glTF 2.0 itself, with KHR_materials_ior and KHR_materials_specular
  SpecularGlossiness,  ///< KHR_materials_pbrSpecularGlossiness
  Unlit,               ///< KHR_materials_unlit: shows its base colour, neither scatters nor emits
};

/// Names and meanings are those of glTF 2.0 and of the extensions.
struct Material {
  std::string name;
  MaterialModel model = MaterialModel::MetallicRoughness;
  glm::vec4 baseColor{1.0f};  ///< the diffuse factor of specular-glossiness
  float metallic = 1.0f;
  float roughness = 1.0f;  ///< of metallic-roughness only
  float glossiness = 1.0f;
  float ior = 1.5f;
  float specular = 1.0f;             ///< KHR_materials_specular's specularFactor
  glm::vec3 specularColor{1.0f};     ///< specularColorFactor, or the specular factor (F0) of specular-glossiness
  TextureSlot specularTexture;       ///< its alpha scales `specular`
  TextureSlot specularColorTexture;  ///< scales specularColor; of specular-glossiness its alpha scales the glossiness
  /// emissiveFactor times KHR_materials_emissive_strength; radiance in nit, linear Rec.709.
  glm::vec3 emission{0.0f};
  float normalScale = 1.0f;
  TextureSlot baseColorTexture, metallicRoughnessTexture, normalTexture, emissiveTexture;
  /// Every slot, for what is done to all of them alike.
  std::array<TextureSlot*, 6> slots() {
    return {&baseColorTexture, &metallicRoughnessTexture, &normalTexture,
            &emissiveTexture,  &specularTexture,          &specularColorTexture};
  }
  std::array<const TextureSlot*, 6> slots() const {
    return {&baseColorTexture, &metallicRoughnessTexture, &normalTexture,
            &emissiveTexture,  &specularTexture,          &specularColorTexture};
  }
  AlphaMode alphaMode = AlphaMode::Opaque;
  float alphaCutoff = 0.5f;
  bool doubleSided = false;
  bool isEmissive() const {
    return model != MaterialModel::Unlit && (emission.x > 0 || emission.y > 0 || emission.z > 0);
  }
};

/// Triangles of one material. Arrays of attributes that the file lacks are empty.
struct Primitive {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;     ///< unit length
  std::vector<glm::vec4> tangents;    ///< xyz unit length, w = ±1
  std::vector<glm::vec2> uv0, uv1;    ///< uv1 only where a slot of the material reads it
  std::vector<glm::vec4> colors;      ///< COLOR_0, linear, 0 to 1; scales the base colour and its alpha
  std::vector<uint32_t> indices;      ///< three a triangle, each below positions.size()
  int material = -1;                  ///< -1: glTF's default material
  uint32_t influencesPerVertex = 0;   ///< a multiple of four; 0: no skin can deform it
  std::vector<Influence> influences;  ///< so many a vertex
  std::vector<MorphTarget> targets;
};

struct Mesh {
  std::string name;
  std::vector<Primitive> primitives;
};

/// One use of a mesh in the world; the node hierarchy is already multiplied out, at rest.
struct Instance {
  int mesh = -1;
  int node = -1;
  glm::mat4 toWorld{1.0f};
  int skin = -1;  ///< where its mesh's primitives have influences, these place them, and toWorld doesn't
};

enum class LightKind : uint8_t { Point, Spot, Directional };

/// KHR_lights_punctual, in the world.
struct PunctualLight {
  std::string name;
  LightKind kind = LightKind::Point;
  glm::vec3 intensity{0.0f};  ///< colour times intensity: candela, or lux when directional
  glm::vec3 position{0.0f};
  glm::vec3 direction{0.0f, 0.0f, -1.0f};  ///< the way the light travels, unit length
  float range = 0.0f;                      ///< metres; 0: unbounded
  float innerCone = 0.0f, outerCone = 0.785398163f;
  int node = -1;  ///< that it hangs on; -1: none
};

struct Camera {
  std::string name;
  glm::vec3 eye{0.0f};
  glm::vec3 forward{0.0f, 0.0f, -1.0f};  ///< unit length
  glm::vec3 up{0.0f, 1.0f, 0.0f};        ///< unit length, orthogonal to forward
  float verticalFov = 0.785398163f;      ///< radians
  int node = -1;                         ///< that it hangs on; -1: none
};

struct Bounds {
  glm::vec3 low{0.0f}, high{0.0f};
  bool empty = true;
  void add(const glm::vec3& p);
  glm::vec3 centre() const { return (low + high) * 0.5f; }
  /// Half the diagonal; 0 when empty.
  float radius() const { return empty ? 0.0f : 0.5f * glm::length(high - low); }
};

struct Scene {
  std::string path;  ///< as given by the user
  std::vector<Image> images;
  std::vector<Texture> textures;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<PunctualLight> lights;
  Environment environment;          ///< not the file's: `--environment`
  bool energyCompensation = false;  ///< nor is this: `--energy-compensation`
  std::vector<Camera> cameras;
  std::vector<std::string> warnings;  ///< what the importer left out or mended, once each
  std::vector<Node> nodes;            ///< all of the file's, whether or not its scene shows them
  std::vector<Skin> skins;
  std::vector<Clip> clips;
};

/// Bounds of all instances, in the world, at rest.
Bounds worldBounds(const Scene& scene);

/// A camera that frames the bounds, looking along -Z from the front, 45° high.
Camera framingCamera(const Bounds& bounds, float aspect);

/// From `--camera`: the name of one of the scene's cameras, or "ex,ey,ez,tx,ty,tz[,vfov in degrees]".
/// An empty text takes the scene's first camera, or one that frames `bounds` (without them: the scene at rest). Throws
/// InputError.
Camera chooseCamera(const Scene& scene, const std::string& text, float aspect, const Bounds* bounds = nullptr);

}  // namespace weir::scene
