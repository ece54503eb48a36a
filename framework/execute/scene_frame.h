// What all passes see of scene and frame: camera, frame number, and a scene that may move. Outlives the graphs that are
// run over it.
#pragma once

#include <weir/execute/frame_constants.h>
#include <weir/execute/scene_motion.h>
#include <weir/gpu/memory.h>
#include <weir/scene/upload.h>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace weir::execute {

struct FrameInput {
  scene::Camera camera;
  uint32_t index = 0;  ///< frame number: a key of the random numbers
  uint32_t seed = 0;
  bool cut = false;  ///< the camera jumped: history is cleared, nothing moved
  /// Where a clip has taken the scene; none: where it was, at first at rest. Ignored where no clip moves the scene.
  const scene::SceneState* state = nullptr;
  /// One a lane, in the place of `seed`: so many lanes, from the first on, have this frame. Empty: the first one alone.
  /// Read before the call returns.
  std::span<const uint32_t> laneSeeds = {};
};

/// One graph at a time records over it: each frame that is recorded is the next one. A frame can have several lanes:
/// runs of the graph that differ in nothing but seed, memory and history.
class SceneFrame {
 public:
  static constexpr uint32_t kSlots = SceneMotion::kSlots;  ///< frames in flight
  static constexpr uint32_t kMostLanes = 64;
  /// Bytes from the constants of a frame's lane to those of the next: the largest minUniformBufferOffsetAlignment that
  /// Vulkan allows.
  static constexpr uint32_t kLaneStride = 256;

  /// The scene must outlive this. InputError unless `lanes` is 1 … kMostLanes.
  SceneFrame(const gpu::Device& device, shader::Compiler& compiler, const scene::SceneGpu& scene, uint32_t lanes = 1);
  ~SceneFrame();
  SceneFrame(const SceneFrame&) = delete;
  SceneFrame& operator=(const SceneFrame&) = delete;

  /// The next frame starts without a past, as the first one does.
  void forget() { fresh_ = true; }
  /// Whether the frame that begins now is such a one.
  bool fresh() const { return fresh_; }

  /// How many lanes there are, and how many of them the frame that begins now, or began last, has.
  uint32_t lanes() const { return lanes_; }
  uint32_t active() const { return active_; }

  /// Brings the scene to the frame's state and writes its constants. The slot's last frame must be done. InputError
  /// when there are fewer lanes than seeds, or a lane that the last frame did not have is to go on without a cut.
  void begin(VkCommandBuffer commands, const FrameInput& input, uint32_t slot, uint32_t width, uint32_t height);
  /// The frame is recorded.
  void end();

  uint32_t parity() const { return static_cast<uint32_t>(frames_ & 1u); }  ///< of the frame that is being recorded
  uint64_t frames() const { return frames_; }                              ///< recorded so far
  VkDescriptorSet set() const { return sets_[parity()]; }
  uint32_t constantsOffset(uint32_t slot) const { return slot * lanes_ * kLaneStride; }  ///< of the first lane
  const std::vector<scene::SceneGpu::Draw>& draws() const { return motion_ ? motion_->draws() : scene_.draws; }
  const scene::SceneGpu& scene() const { return scene_; }
  const gpu::Buffer& rayCounter() const { return rayCounter_; }
  /// What a moving scene takes besides SceneGpu::bytes().
  uint64_t motionBytes() const { return motion_ ? motion_->bytes() : 0; }

 private:
  void activate(const FrameInput& input);
  void writeConstants(const FrameInput& input, uint32_t slot, uint32_t width, uint32_t height);

  const scene::SceneGpu& scene_;
  uint32_t lanes_;
  uint32_t active_, activeBefore_;  ///< lanes of the frame that is being recorded, and of the last one
  gpu::Buffer constants_, rayCounter_;
  std::unique_ptr<SceneMotion> motion_;    ///< only where a clip moves the scene
  std::array<VkDescriptorSet, 2> sets_{};  ///< by parity; of a still scene both are one
  uint64_t frames_ = 0;
  bool fresh_ = true;
  GpuCamera camera_, previousCamera_;  ///< of the frame that is being recorded, and of the last one
};

}  // namespace weir::execute
