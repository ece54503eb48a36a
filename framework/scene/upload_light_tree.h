// A light tree on the device, for the passes that pick lights by place. Internal to scene/upload.
#pragma once

#include <weir/gpu/memory.h>
#include <weir/scene/prepared.h>

#include <array>

namespace weir::scene {

/// What stands before the entries, 48 bytes, as execute/prelude.cpp declares it.
struct GpuTreeHead {
  uint32_t lights = 0, unplaced = 0, levels = 0, cutLevels = 0;
  glm::vec3 origin{0.0f};  ///< m
  float unit = 1.0f;
  uint32_t unplacedShare = 0;  ///< in parts of 2²⁴
  uint32_t pad[3] = {0, 0, 0};
};
static_assert(sizeof(GpuTreeHead) == 48);

class LightTreeGpu {
 public:
  static constexpr uint32_t kBuffers = 3;

  /// Builds, uploads and waits. Throws what buildLightTree() throws.
  LightTreeGpu(const gpu::Device& device, const PreparedScene& prepared);

  /// Lights that moved or have other powers, as many of each kind as before: the buffers stay the same. Waits.
  void update(const gpu::Device& device, const PreparedScene& prepared);

  /// Nodes; placed lights; GpuTreeHead with the entries.
  std::array<VkBuffer, kBuffers> buffers() const { return {nodes_.handle(), lights_.handle(), entries_.handle()}; }
  uint64_t bytes() const { return nodes_.size() + lights_.size() + entries_.size(); }

 private:
  gpu::Buffer nodes_, lights_, entries_;
};

}  // namespace weir::scene
