// Acceleration structures of a scene that a clip moves: this frame's and last frame's. Bottom-level structures of what
// keeps its shape are shared with trace/acceleration.h.
#pragma once

#include <weir/scene/scene_state.h>
#include <weir/trace/acceleration.h>

#include <array>
#include <memory>
#include <span>
#include <vector>

namespace weir::trace {

/// Even frames use half 0, odd ones half 1. Deforming ranges are built once and then refitted, the top is built anew
/// every frame: it is small, and a refitted one would grow ever worse as instances wander.
class MovingAcceleration {
 public:
  /// `positions[h]` holds the vertices of half h. The references must outlive this.
  MovingAcceleration(const gpu::Device& device, const scene::PreparedScene& scene, const Acceleration& still,
                     const std::array<VkDeviceAddress, 2>& positions);

  VkAccelerationStructureKHR top(uint32_t half) const { return halves_[half].top.handle(); }
  /// The buffer that `record` reads a half's instances from, and what must be copied there before.
  VkBuffer instances(uint32_t half) const { return halves_[half].instances.handle(); }
  /// `into`: as many as the scene has instances.
  void packInstances(const scene::SceneState& state, uint32_t half,
                     std::span<VkAccelerationStructureInstanceKHR> into) const;
  /// Builds (`fresh`: nothing usable is there yet) or refits a half. Vertices and instances must be visible to builds;
  /// what follows must wait for the build stage's writes.
  void record(VkCommandBuffer commands, uint32_t half, bool fresh) const;
  uint64_t bytes() const;

 private:
  struct Bottom {
    RangeGeometry geometry;
    Structure structure;
    uint64_t scratch = 0;  ///< offset
  };
  struct Half {
    std::vector<Bottom> bottom;      ///< of the deforming ranges
    std::vector<int> bottomOfRange;  ///< -1: the still one
    gpu::Buffer instances;
    Structure top;
    /// What builds the bottom structures, laid out once: frames allocate nothing.
    std::vector<VkAccelerationStructureBuildGeometryInfoKHR> build, refit;
    std::vector<std::vector<VkAccelerationStructureBuildRangeInfoKHR>> ranges;
    std::vector<const VkAccelerationStructureBuildRangeInfoKHR*> rangePointers;
  };
  void layOutBuilds(Half& half) const;
  VkAccelerationStructureBuildGeometryInfoKHR bottomInfo(const Bottom& bottom) const;

  const scene::PreparedScene& scene_;
  const Acceleration& still_;
  std::array<Half, 2> halves_;
  gpu::Buffer scratch_;  ///< both halves use it, one after the other
  uint64_t topScratch_ = 0;
};

}  // namespace weir::trace
