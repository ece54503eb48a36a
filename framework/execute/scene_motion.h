// A scene that a clip moves, on the device: transforms, lights, deformed vertices and acceleration structures of this
// frame and of the last one. Written anew within each frame's submission.
#pragma once

#include <weir/execute/light_table.h>
#include <weir/execute/pipelines.h>
#include <weir/scene/scene_state.h>
#include <weir/scene/upload.h>
#include <weir/shader/compiler.h>
#include <weir/trace/moving_acceleration.h>

#include <array>
#include <memory>
#include <optional>
#include <vector>

namespace weir::execute {

/// Even frames write half 0 and read half 1 as the past, odd ones the other way round. What has no past that anybody
/// could ask for (normals, alias table) exists once.
class SceneMotion {
 public:
  static constexpr uint32_t kSlots = 2;  ///< frames in flight

  /// The scene must outlive this. `tableOnDevice`: whether the device builds the alias table of lights whose powers
  /// change, where it can; else the CPU does.
  SceneMotion(const gpu::Device& device, shader::Compiler& compiler, const scene::SceneGpu& scene,
              bool tableOnDevice = true);
  ~SceneMotion();
  SceneMotion(const SceneMotion&) = delete;
  SceneMotion& operator=(const SceneMotion&) = delete;

  /// What a kernel sees in the frames that write this half.
  scene::MovingBindings bindings(uint32_t half) const;
  /// Brings the scene to a state (none: as it was, at first at rest). `fresh`: the past is the same as the present.
  /// Everything earlier in the queue is waited for, and everything later may read. The slot's last frame must be done.
  void record(VkCommandBuffer commands, uint32_t slot, uint32_t half, const scene::SceneState* state, bool fresh);

  /// Of this frame and the last one, as in scene/upload.h.
  float diameter() const;
  float largestSide() const;
  const std::vector<scene::SceneGpu::Draw>& draws() const { return draws_; }
  uint64_t bytes() const;

 private:
  /// A part of the staging buffer.
  struct Part {
    uint64_t offset = 0, size = 0;
  };
  void layOut();
  void makeLights(shader::Compiler& compiler);
  void makeKernel(shader::Compiler& compiler);
  template <typename T>
  void stage(uint32_t slot, const Part& part, const std::vector<T>& values);
  void copy(VkCommandBuffer commands, uint32_t slot, const Part& part, VkBuffer to) const;
  void upload(VkCommandBuffer commands, uint32_t slot, uint32_t half, bool fresh);
  void deform(VkCommandBuffer commands, uint32_t half) const;
  void tabulate(VkCommandBuffer commands, uint32_t half, bool fresh) const;

  const gpu::Device& device_;
  const scene::SceneGpu& scene_;
  const scene::PreparedScene& prepared_;
  scene::SceneState state_;
  float previousDiameter_ = 0.0f, previousLargestSide_ = 0.0f;
  std::vector<scene::GpuInstance> packed_;
  std::vector<scene::SceneGpu::Draw> draws_;
  std::vector<VkAccelerationStructureInstanceKHR> topInstances_;

  std::array<gpu::Buffer, 2> instances_, lights_, positions_;
  bool tableOnDevice_;
  gpu::Buffer alias_, powers_, vertices_, influences_, deltas_, flat_, joints_, weights_;
  gpu::Buffer staging_;
  uint64_t slotBytes_ = 0;
  Part instancesPart_, lightsPart_, aliasPart_, powersPart_, jointsPart_, weightsPart_;
  std::array<Part, 2> topPart_;
  std::optional<trace::MovingAcceleration> acceleration_;
  std::optional<LightTable> table_;  ///< where powers change and the device can; else the CPU builds it
  std::vector<float> relativePowers_;

  Pipeline kernel_;
  VkDescriptorSetLayout setLayout_ = VK_NULL_HANDLE;
  VkPipelineLayout pipelineLayout_ = VK_NULL_HANDLE;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  std::array<VkDescriptorSet, 2> sets_{};
};

}  // namespace weir::execute
