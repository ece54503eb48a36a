// A prepared scene on the device: buffers, textures, acceleration structures, and the descriptor set 0 that every
// kernel shares.
#pragma once

#include <weir/gpu/memory.h>
#include <weir/scene/prepared.h>
#include <weir/scene/upload_environment.h>
#include <weir/trace/acceleration.h>

#include <array>
#include <memory>
#include <mutex>
#include <vector>

namespace weir::scene {

class LightTreeGpu;  // scene/upload_light_tree.h

/// Binding numbers in set 0, as the generated prelude declares them.
enum SceneBinding : uint32_t {
  kBindFrame = 0,
  kBindPositions,
  kBindVertices,
  kBindTriangles,
  kBindInstances,
  kBindMaterials,
  kBindLights,
  kBindAlias,
  kBindLightOfTriangle,  ///< with the trait triangleLights
  kBindColors,           ///< with the trait vertexColors
  kBindUvs1,             ///< with uvSets
  kBindSpeculars,        ///< with one of the specular traits
  kBindTextureUses,      ///< with uvSets, uvTransforms or mipmaps
  kBindSpecularAlbedo,   ///< with energyCompensation
  kBindRays,             ///< ray counter
  kBindAcceleration,     ///< only on devices with acceleration structures
  kBindEnvironment,      ///< its table; only in scenes that have one, as the next
  kBindEnvironmentMap,
  // As in the last frame; only where a clip moves the scene.
  kBindPreviousPositions,
  kBindPreviousInstances,
  kBindPreviousLights,
  kBindPreviousAcceleration,
  kBindTextures,  ///< last: an array of as many as the scene has
};

/// An instance as shaders read it, 80 bytes.
struct GpuInstance {
  glm::vec4 columns[4];
  uint32_t firstTriangle = 0, opaqueTriangles = 0, flipsWinding = 0;
  uint32_t firstDrawn = 0;  ///< number of triangles in the instances before it
};
static_assert(sizeof(GpuInstance) == 80);

/// How a texture of the array is read, 32 bytes.
struct GpuTextureUse {
  glm::vec4 linear{1, 0, 0, 1};  ///< columns of UvTransform::linear
  glm::vec2 offset{0.0f};
  uint32_t uvSet = 0;
  /// log2 of how many texels a unit of length in untransformed coordinates is, as the mean over directions by area.
  float texelLevel = 0.0f;
};
static_assert(sizeof(GpuTextureUse) == 32);
/// What stands in set 0 where a clip moves the scene, in place of the scene's own: this frame's and the last one's.
struct MovingBindings {
  VkBuffer positions = VK_NULL_HANDLE, vertices = VK_NULL_HANDLE, instances = VK_NULL_HANDLE, lights = VK_NULL_HANDLE,
           alias = VK_NULL_HANDLE;
  VkBuffer previousPositions = VK_NULL_HANDLE, previousInstances = VK_NULL_HANDLE, previousLights = VK_NULL_HANDLE;
  VkAccelerationStructureKHR top = VK_NULL_HANDLE, previousTop = VK_NULL_HANDLE;
};

class SceneGpu {
 public:
  /// Uploads and builds everything, and waits. `scene` and `prepared` must outlive this. Where the scene's traits say
  /// that a clip moves it, the buffers hold it at rest.
  SceneGpu(const gpu::Device& device, const Scene& scene, const PreparedScene& prepared, bool withAcceleration);
  ~SceneGpu();
  SceneGpu(const SceneGpu&) = delete;
  SceneGpu& operator=(const SceneGpu&) = delete;

  VkDescriptorSetLayout layout() const { return layout_; }
  /// A set over this scene, the given frame constants (dynamic offset, `slotBytes` visible) and ray counter.
  /// `moving` is wanted where the traits say so, and else left out.
  VkDescriptorSet makeSet(const gpu::Buffer& frameConstants, uint64_t slotBytes, const gpu::Buffer& rayCounter,
                          const MovingBindings* moving = nullptr) const;
  void freeSet(VkDescriptorSet set) const;

  /// Takes over lights and alias table, of the same number as before; waits for the device. The rest of the scene is
  /// what it was.
  void updateLights(const PreparedScene& prepared);

  uint64_t bytes() const;
  uint32_t textureCount() const { return static_cast<uint32_t>(textures_.size()); }
  bool hasAcceleration() const { return withAcceleration_; }
  /// What a clip moves, for execute/scene_motion.h.
  const Scene& source() const { return *scene_; }
  const PreparedScene& prepared() const { return *prepared_; }
  const trace::Acceleration& acceleration() const { return acceleration_; }
  VkBuffer positions() const { return positions_.handle(); }
  VkBuffer vertices() const { return vertices_.handle(); }
  VkBuffer lights() const { return lights_.handle(); }
  VkBuffer alias() const { return alias_.handle(); }
  /// For picks of lights by place: built when first asked for, from lights at rest. Any thread may ask.
  const LightTreeGpu& lightTree() const;

  SceneTraits traits;  ///< shaders are compiled for them

  // What the frame constants say of the scene.
  uint32_t lightCount = 0, instanceCount = 0;
  uint32_t placedLights = 0;  ///< how many of the lights have a place, scene/light_tree.h
  float diameter = 0.0f;      ///< of the bounding sphere, metres; at least twice the float error of its place
  float largestSide =
      0.0f;  ///< longest side of any triangle in the world, metres: rays meet it with an error that grows with it
  struct Draw {
    uint32_t triangles;
    bool doubleSided, flipsWinding;
  };
  double accelerationSeconds = 0.0;  ///< what building the acceleration structures took
  std::vector<Draw> draws;           ///< per instance, for rasterisation

 private:
  void uploadTextures(const Scene& scene, const PreparedScene& prepared);
  VkSampler samplerOf(const PreparedTexture& texture);
  void makeLayout();

  const gpu::Device* device_;
  const Scene* scene_;
  const PreparedScene* prepared_;
  bool withAcceleration_;
  gpu::Buffer positions_, vertices_, triangles_, instances_, materials_, lights_, alias_, lightOfTriangle_, colors_,
      uvs1_, speculars_, textureUses_, specularAlbedo_;
  struct Texture {
    uint32_t image;
    VkSampler sampler;
  };
  std::vector<gpu::Image> images_;
  std::vector<std::pair<PreparedTexture, VkSampler>> samplers_;  // by a texture whose filters and wraps it has
  std::vector<Texture> textures_;
  EnvironmentGpu environment_;
  trace::Acceleration acceleration_;
  mutable std::mutex treeMutex_;
  mutable std::unique_ptr<LightTreeGpu> lightTree_;
  VkDescriptorSetLayout layout_ = VK_NULL_HANDLE;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
};

/// The prepared instances as shaders read them, where they are at rest, and what rasterisation draws of each.
std::vector<GpuInstance> packInstances(const PreparedScene& prepared, std::vector<SceneGpu::Draw>& draws);
/// Of the bounding sphere; at least twice the float error of its place.
float diameterOf(const Bounds& bounds);

}  // namespace weir::scene
