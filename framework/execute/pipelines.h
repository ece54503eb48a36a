// Vulkan pipelines of three kinds behind one face: compute, ray tracing with its shader binding table, raster.
#pragma once

#include <weir/gpu/memory.h>
#include <weir/graph/compile.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace weir::execute {

/// Values of specialisation constants 0, 1, …, four bytes each.
using Specialization = std::vector<uint32_t>;

/// A plan's stages as Vulkan calls them.
VkPipelineStageFlags2 vulkanStages(graph::Stages stages);
/// How kernels in these stages write what belongs to the graph: storage, and what raster kernels draw into.
VkAccessFlags2 writeAccess(graph::Stages stages);
VkAccessFlags2 readAccess(graph::Stages stages);

struct HitShaders {
  std::vector<uint32_t> closestHit, closestAnyHit, closestMiss, shadowAnyHit, shadowMiss;
};

/// Moves only; frees itself.
class Pipeline {
 public:
  Pipeline() = default;
  /// `groupSide` is that of the shader's workgroups; 0: linear ones of kRowGroup (prelude.h).
  static Pipeline compute(const gpu::Device& device, VkPipelineLayout layout, std::span<const uint32_t> spirv,
                          const Specialization& constants, uint32_t groupSide, const std::string& name);
  static Pipeline rays(const gpu::Device& device, VkPipelineLayout layout, std::span<const uint32_t> rayGeneration,
                       const HitShaders& hits, const Specialization& constants, const std::string& name);
  /// Draws into one color target of `format` and a D32 depth buffer, reversed depth; culling is dynamic state.
  static Pipeline raster(const gpu::Device& device, VkPipelineLayout layout, std::span<const uint32_t> vertex,
                         std::span<const uint32_t> fragment, VkFormat format, const Specialization& constants,
                         const std::string& name);
  ~Pipeline();
  Pipeline(Pipeline&& other) noexcept;
  Pipeline& operator=(Pipeline&& other) noexcept;

  VkPipeline handle() const { return pipeline_; }
  /// Launches width × height invocations (compute: in whole groups). Everything must be bound.
  void launch(VkCommandBuffer commands, uint32_t width, uint32_t height) const;
  VkPipelineBindPoint bindPoint() const { return bindPoint_; }
  graph::Stages stages() const;

 private:
  const gpu::Device* device_ = nullptr;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
  VkPipelineBindPoint bindPoint_ = VK_PIPELINE_BIND_POINT_COMPUTE;
  uint32_t groupSide_ = 0;
  gpu::Buffer table_;
  VkStridedDeviceAddressRegionKHR generation_{}, miss_{}, hit_{}, callable_{};
};

}  // namespace weir::execute
