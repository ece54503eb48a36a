// Runs a compiled graph frame after frame: one submission a frame, two in flight, timestamps around every pass.
#pragma once

#include <weir/execute/frame_constants.h>
#include <weir/execute/pass_runtime.h>
#include <weir/execute/scene_motion.h>
#include <weir/image/image.h>

#include <cstddef>
#include <deque>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace weir::execute {

struct ExecutorOptions {
  trace::Backend backend = trace::Backend::None;
  bool countRays = false;   ///< an atomic add a ray: for statistics, not for timing
  std::string sceneFolder;  ///< what passes resolve relative files against
};

struct FrameInput {
  scene::Camera camera;
  uint32_t index = 0;  ///< frame number: a key of the random numbers
  uint32_t seed = 0;
  bool cut = false;  ///< the camera jumped: history is cleared, nothing moved
  /// Where a clip has taken the scene; none: where it was, at first at rest. Ignored where no clip moves the scene.
  const scene::SceneState* state = nullptr;
};

/// Milliseconds of one frame.
struct FrameTimes {
  std::vector<double> gpu, cpu;  ///< by pass; gpu is empty on devices without timestamps
  double gpuFrame = 0.0, cpuFrame = 0.0;
  double gpuScene = 0.0;  ///< of bringing the scene to its state, part of gpuFrame
};

class Executor {
 public:
  /// Compiles every shader and allocates everything. The references must outlive the executor.
  Executor(const gpu::Device& device, shader::Compiler& compiler, Registry& registry, const scene::SceneGpu& scene,
           graph::CompiledGraph graph, const ExecutorOptions& options);
  ~Executor();
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  const graph::CompiledGraph& graph() const { return graph_; }

  /// The next frame starts without history, as the first one does.
  void resetHistory() { clearNext_ = true; }
  /// Records and submits; returns before the GPU is done. Throws RuntimeError (device lost, …).
  void frame(const FrameInput& input);
  /// Waits for everything submitted.
  void finish();

  /// A graph output of the last frame, after finish(); images only: buffers and unknown names throw InputError.
  image::Picture read(const std::string& output);
  /// Meaning of an output port: how a PNG must encode it.
  Meaning meaning(const std::string& output) const;
  /// Raw bytes of a resource ("pass.port") as the last frame left it, and, for tests, putting some in before a frame.
  std::vector<std::byte> readResource(const std::string& name);
  void writeResource(const std::string& name, std::span<const std::byte> bytes);

  /// Times of finished frames since the last call, oldest first.
  std::vector<FrameTimes> takeTimes();
  /// Rays of the last finished frame; 0 unless countRays.
  uint64_t rays() const { return rays_; }
  uint64_t transientBytes() const;
  uint64_t historyBytes() const { return resources_.historyBytes(); }
  /// What a moving scene takes besides SceneGpu::bytes().
  uint64_t motionBytes() const { return motion_ ? motion_->bytes() : 0; }

 private:
  static constexpr uint32_t kSlots = SceneMotion::kSlots;
  struct Slot {
    VkCommandPool pool = VK_NULL_HANDLE;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    VkFence fence = VK_NULL_HANDLE;
    VkQueryPool queries = VK_NULL_HANDLE;
    bool busy = false;
    FrameTimes times;
  };

  void makeSceneSets(shader::Compiler& compiler);
  void freeSceneSets();
  void makeSlots();
  void collect(Slot& slot);
  void writeConstants(const FrameInput& input, uint32_t slot);
  void record(Slot& slot, uint32_t slotIndex, const FrameInput& input);
  void beforePass(VkCommandBuffer commands, size_t pass) const;
  uint32_t resourceNamed(const std::string& name) const;
  std::vector<std::byte> download(const Storage& storage);
  void stamp(const Slot& slot, uint32_t query) const;

  const gpu::Device& device_;
  graph::CompiledGraph graph_;
  const scene::SceneGpu& scene_;
  Resources resources_;
  Shared shared_;
  gpu::Buffer constants_, rayCounter_;
  std::unique_ptr<SceneMotion> motion_;         ///< only where a clip moves the scene
  std::array<VkDescriptorSet, 2> sceneSets_{};  ///< by parity; of a still scene both are one
  std::vector<std::unique_ptr<PassRuntime>> passes_;
  std::array<Slot, kSlots> slots_;
  uint64_t frames_ = 0;
  bool clearNext_ = true;
  GpuCamera previousCamera_;
  std::deque<FrameTimes> times_;
  uint64_t rays_ = 0;
};

}  // namespace weir::execute
