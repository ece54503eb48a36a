// The scene as a GPU reads it, still plain data: static geometry merged in the world and sorted for the acceleration
// structure, vertices packed, lights gathered. scene/upload.h only copies this; shaders/common/scene.glsl reads it.
#pragma once

#include <weir/scene/lights.h>
#include <weir/scene/mipmaps.h>
#include <weir/scene/scene.h>
#include <weir/scene/traits.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace weir::scene {

/// Vertex attributes besides the position, 16 bytes.
struct PackedVertex {
  uint32_t normal = 0;  ///< octahedral, 2 × snorm16
  uint32_t tangent =
      0;  ///< octahedral, snorm16 + snorm15, lowest bit of the upper half set when the bitangent's sign is -1
  float u = 0.0f, v = 0.0f;
};
static_assert(sizeof(PackedVertex) == 16);

/// COLOR_0: the square roots of its colours and its alpha in 4 × unorm16. Colours from 2.5e-4 on are off by less than
/// 0.1 % (by 0.0015 % at 1); 0, 1 and every alpha that glTF's integers can say are exact. 8 bytes.
struct PackedColor {
  uint32_t rg = 0xffffffffu, ba = 0xffffffffu;
};
static_assert(sizeof(PackedColor) == 8);

/// Indices into positions and vertices, and the material. 16 bytes.
struct PackedTriangle {
  uint32_t v[3] = {0, 0, 0};
  uint32_t material = 0;
};
static_assert(sizeof(PackedTriangle) == 16);

/// Material flags in PackedMaterial::flags.
inline constexpr uint32_t kMaterialMask = 1u << 0;
inline constexpr uint32_t kMaterialBlend = 1u << 1;
inline constexpr uint32_t kMaterialDoubleSided = 1u << 2;
inline constexpr uint32_t kMaterialEmissive = 1u << 3;
inline constexpr uint32_t kMaterialSpecularGlossiness = 1u << 4;
inline constexpr uint32_t kMaterialUnlit = 1u << 5;

/// 64 bytes. Texture fields are indices into PreparedScene::textures, -1: none.
struct PackedMaterial {
  glm::vec4 baseColor{1.0f};
  glm::vec3 emission{0.0f};  ///< nit
  float alphaCutoff = 0.5f;
  float metallic = 1.0f, roughness = 1.0f, normalScale = 1.0f;  ///< `roughness` of specular-glossiness: its glossiness
  uint32_t flags = 0;
  int32_t baseColorTexture = -1, metallicRoughnessTexture = -1, normalTexture = -1, emissiveTexture = -1;
};
static_assert(sizeof(PackedMaterial) == 64);

/// What a material's specular reflection is made of besides PackedMaterial, 32 bytes.
/// Metallic-roughness: the dielectric's F0 = min(f0 · colour texture's rgb, 1) · weight · weight texture's alpha.
/// Specular-glossiness: F0 = f0 · colour texture's rgb; its alpha scales the glossiness.
struct PackedSpecular {
  glm::vec3 f0{0.04f};
  float weight = 1.0f;  ///< also F90 of the dielectric
  int32_t colorTexture = -1, weightTexture = -1;
  uint32_t pad[2] = {0, 0};
};
static_assert(sizeof(PackedSpecular) == 32);

/// An image as one slot uses it: the same image in a colour and in a data slot becomes two.
struct PreparedTexture {
  int image = -1;  ///< into Scene::images
  MipContent content;
  Wrap wrapS = Wrap::Repeat, wrapT = Wrap::Repeat;
  Filter magFilter = Filter::Linear, minFilter = Filter::Linear;
  MipFilter mipFilter = MipFilter::None;
  uint32_t uvSet = 0;
  UvTransform transform;
  bool operator==(const PreparedTexture&) const = default;
};

/// Triangles that share a bottom-level acceleration structure: opaque ones first, then those with an alpha test.
/// Both ranges are sorted spatially (median split), since a software device builds in input order.
/// Its materials are either all single-sided or all double-sided: what the camera sees through is decided an instance.
struct TriangleRange {
  uint32_t first = 0, opaque = 0, masked = 0;
  bool doubleSided = false;
  int deformation = -1;  ///< of its vertices, which no other range shares; -1: they keep their places
};

/// What moves the vertices of one range while a clip plays: morph targets, then a skin. Where a skin is, the vertices
/// end up in the world.
struct Deformation {
  uint32_t firstVertex = 0, vertices = 0;                ///< into PreparedScene::positions
  uint32_t influencesPerVertex = 0, firstInfluence = 0;  ///< into influences; 0 a vertex: no skin
  uint32_t firstJoint = 0, joints = 0;    ///< into SceneState::joints; Influence::joint counts from first
  uint32_t targets = 0, firstWeight = 0;  ///< into SceneState::weights
  /// Vectors a vertex and target (1: position; 2: and normal; 3: and tangent), into morphDeltas:
  /// [target][vertex][kind].
  uint32_t kinds = 0, firstDelta = 0;
  uint32_t firstFlat = 0, flats = 0;  ///< into flatTriangles: those without stored normals
  bool mirrors = false;               ///< see deformed() in scene/pose.h
};

/// An instance in the top-level structure; ranges 0 and 1 are the merged static geometry, single-sided and
/// double-sided, with identity transforms. Triangle t of a hit = range.first + (geometry == 1 ? range.opaque : 0) +
/// primitive.
struct PreparedInstance {
  uint32_t range = 0;
  glm::mat4 toWorld{1.0f};
  bool flipsWinding = false;  ///< the transform mirrors: front faces are clockwise in object space
  int node = -1;              ///< whose world matrix it follows while a clip plays; -1: it stays
};

/// A light that a clip moves.
struct MovingLight {
  uint32_t light = 0;      ///< into PreparedScene::lights
  int instance = -1;       ///< that a triangle belongs to
  int source = -1;         ///< of a punctual one: into Scene::lights
  double radiosity = 0.0;  ///< of a triangle: its power for an m²
};

struct PreparedScene {
  std::vector<glm::vec3> positions;
  std::vector<PackedVertex> vertices;  ///< beside positions
  std::vector<PackedColor> colors;     ///< likewise; empty without the trait vertexColors
  std::vector<glm::vec2> uvs1;         ///< likewise, the second set; empty without the trait uvSets
  std::vector<PackedTriangle> triangles;
  std::vector<TriangleRange> ranges;        ///< [0] and [1] may be empty
  std::vector<PreparedInstance> instances;  ///< never empty when there are triangles
  std::vector<PackedMaterial> materials;    ///< the last one is glTF's default material
  std::vector<PackedSpecular> speculars;    ///< beside materials; empty unless a specular trait holds
  std::vector<float> specularAlbedo;        ///< scene/specular_albedo.h; empty without the trait energyCompensation
  std::vector<PreparedTexture> textures;
  std::vector<GpuLight> lights;       ///< those that can emit at all, triangles first
  std::vector<AliasCell> aliasTable;  ///< empty when there are no lights
  uint32_t triangleLights = 0;        ///< how many of `lights` are triangles
  /// Which light a triangle is, for rays that hit one: entry [triangle - firstLitTriangle], kNoLight where it is none.
  /// Reaches from the first light's triangle to the last one's; empty without any.
  std::vector<uint32_t> lightOfTriangle;
  uint32_t firstLitTriangle = 0;
  EnvironmentTable environment;  ///< of Scene::environment, which is the last of `lights`
  SceneTraits traits;
  Bounds bounds;                  ///< at rest
  uint64_t droppedTriangles = 0;  ///< degenerate or not finite

  /// Where vertex v reads a texture: its set of coordinates, transformed.
  glm::vec2 textureUv(const PreparedTexture& texture, uint32_t v) const {
    return texture.transform(texture.uvSet == 1 ? uvs1[v] : glm::vec2(vertices[v].u, vertices[v].v));
  }

  // What a clip moves (scene/scene_state.h); empty in a still scene.
  std::vector<Deformation> deformations;
  std::vector<Influence> influences;
  std::vector<glm::vec3> morphDeltas;
  std::vector<glm::uvec3> flatTriangles;  ///< vertices of triangles whose normal follows from them
  std::vector<int> posedSkins;            ///< whose joint matrices lie in SceneState::joints, one after another
  std::vector<int> posedNodes;            ///< whose morph weights lie in SceneState::weights
  std::vector<MovingLight> movingLights;
  std::vector<double> lightPower;  ///< weights of the alias table, beside lights; only where lights move

  /// Whether the clip changes powers of lights, and the alias table with them: areas of triangles.
  bool lightPowerChanges() const {
    return std::any_of(movingLights.begin(), movingLights.end(), [](const MovingLight& m) { return m.instance >= 0; });
  }
  /// Whether an instance's transform or vertices change while the clip plays.
  bool moves(const PreparedInstance& instance) const {
    return instance.node >= 0 || ranges[instance.range].deformation >= 0;
  }
};

/// Arranges a scene, CPU only. Alpha-tested are the materials with mask or blend. Under an instance that flips the
/// winding, object-space tangents' bitangent signs flip too. Textured triangle lights (kLightTextured): radiance is the
/// factor alone, power uses the texture's mean over the triangle's texels; a triangle whose texels are all black is no
/// light. Emission is scaled by coverage where the material has alpha: the radiance by one that is the same all over,
/// else the power by its mean (kLightAlpha); a triangle that covers nothing is no light. Static meshes are merged into
/// world space (winding mended under mirroring transforms) except those that are shared so often that merging would
/// multiply memory; emissive ones are always merged, so that a light's triangle is unique. Power of a triangle: π ·
/// area · luminance of its mean emission (twice that when double-sided); of a point 4π · luminance of its intensity; a
/// spot by its cone; a directional by the area of the scene's disc; an environment as the directionals that it is made
/// of. A mesh is not merged when `uses >= mergeUses` and `uses * triangles > mergeTriangles`.
struct PrepareLimits {
  uint64_t mergeTriangles = 2'000'000;
  uint32_t mergeUses = 4;
};
/// With a clip, what that clip moves stays apart: meshes under nodes that it moves are instances, skinned and morphed
/// ones have vertices of their own. Everything else is merged as it is at rest, and without a clip that is all.
PreparedScene prepareScene(const Scene& scene, const PrepareLimits& limits = {}, const Clip* clip = nullptr);

/// What `weir scene` prints.
struct SceneSummary {
  uint64_t storedTriangles = 0, instancedTriangles = 0, vertices = 0;
  uint32_t meshes = 0, primitives = 0, instances = 0, materials = 0, maskedMaterials = 0, blendMaterials = 0,
           glossyMaterials = 0, unlitMaterials = 0, coloredPrimitives = 0, uvTransforms = 0, textures = 0, images = 0,
           cameras = 0, animations = 0;
  uint32_t pointLights = 0, spotLights = 0, directionalLights = 0;
  uint64_t emissiveTriangles = 0;  ///< of materials with a non-zero emissive factor
  Bounds bounds;
};
SceneSummary summarize(const Scene& scene);

}  // namespace weir::scene
