// Runs a graph frame after frame: one submission a frame, two in flight, timestamps around every pass. The graph can be
// swapped for another between two frames. It can run in several lanes: the same frames with other seeds, each lane with
// memory and history of its own, launch by launch side by side in one submission, so that small pictures fill a GPU.
#pragma once

#include <weir/execute/graph_runtime.h>
#include <weir/image/image.h>

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace weir::execute {

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

  /// With scratch memory, places and barriers as they are on this device.
  const graph::CompiledGraph& graph() const { return runtime_->graph(); }
  const GraphRuntime& runtime() const { return *runtime_; }

  /// Goes on with another graph, or the same with other parameters or another size. History goes on where pass, type,
  /// layout and size are the same, and is empty elsewhere. When it throws, the graph that was there goes on.
  void swap(graph::CompiledGraph graph);
  /// The same, and everything is prepared anew whatever changed: for shaders or plugins that were edited.
  void restart(graph::CompiledGraph graph);
  /// Compiles the shaders anew from their files. When one does not compile it throws, and the old ones go on.
  void reloadShaders() { restart(source_); }
  /// Every file that shaders were read from; after a swap or reload that failed also those that it looked for.
  const std::set<std::string>& shaderFiles() const { return shaderFiles_; }
  /// Pipelines that were made so far: what a swap or a reload had to compile.
  uint64_t pipelinesMade() const { return pipelines_.made(); }

  /// The next frame starts without history, as the first one does.
  void resetHistory() { scene_.forget(); }
  /// Records and submits; returns before the GPU is done. Throws RuntimeError (device lost, …). With `capture` the
  /// outputs named by captureTo() are brought to the host by the same submission. Which lanes it has, `input.laneSeeds`
  /// says. InputError for more lanes than there are, or for one that the last frame did not have, unless history starts
  /// anew.
  void frame(const FrameInput& input, bool capture = false);
  /// Waits for everything submitted.
  void finish();

  /// What becomes of captured pictures: called once for each output of each lane of each captured frame, in order, from
  /// within a later frame() or finish(), when the frame is over. So nobody waits for a picture. Names as for read(). A
  /// swap that changes anything but parameters ends it. The sink must not call frame(), captureTo(), swap() or the
  /// like: InputError.
  using Sink = std::function<void(const std::string& output, const image::Picture&)>;
  void captureTo(const std::vector<std::string>& outputs, Sink sink);
  /// The same, called with the pictures of all lanes of a frame at once.
  using LaneSink = std::function<void(const std::string& output, std::span<const image::Picture>)>;
  void captureLanesTo(const std::vector<std::string>& outputs, LaneSink sink);
  /// A graph output of the last frame, after finish(); images only: buffers and unknown names throw InputError, and so
  /// does a lane that the frame did not have.
  image::Picture read(const std::string& output, uint32_t lane = 0);
  /// Meaning of an output port: how a PNG must encode it.
  Meaning meaning(const std::string& output) const;
  /// Raw bytes of a resource ("pass.port") as the last frame left it. InputError where somebody else uses the memory:
  /// compile the graph with `keep`.
  std::vector<std::byte> readResource(const std::string& name, uint32_t lane = 0);
  /// Where a resource ("pass.port", "pass.port@previous" for the frame before) lies after the last frame.
  struct Located {
    const Storage* storage = nullptr;  ///< images are in VK_IMAGE_LAYOUT_GENERAL
    const graph::Resource* resource = nullptr;
  };
  /// For commands that are submitted to the device's queue before the next frame is: they begin with a barrier that
  /// waits for everything earlier, and end with one that everything later waits for. Valid until the next frame, swap
  /// or restart. InputError as for readResource(), and before the graph has run.
  Located locate(const std::string& name, uint32_t lane = 0) const;
  /// For tests: what a resource holds before the next frame, in the first lane; of one that shares memory, until
  /// somebody else takes it.
  void writeResource(const std::string& name, std::span<const std::byte> bytes);

  /// Times of finished frames since the last call, oldest first; of the last kTimesKept at most.
  std::vector<FrameTimes> takeTimes();
  static constexpr size_t kTimesKept = 64;
  /// Rays of the last finished frame; 0 unless countRays.
  uint64_t rays() const { return rays_; }
  /// Of all lanes, as the ones below.
  uint64_t transientBytes() const { return scene_.lanes() * graph().transientBytes(); }
  uint64_t historyBytes() const { return scene_.lanes() * graph().historyBytes(); }
  /// What transient resources would take more if they shared no memory.
  uint64_t savedBytes() const;
  uint64_t motionBytes() const { return scene_.motionBytes(); }

 private:
  static constexpr uint32_t kSlots = SceneFrame::kSlots;
  struct Slot {
    VkCommandPool pool = VK_NULL_HANDLE;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    VkFence fence = VK_NULL_HANDLE;
    VkQueryPool queries = VK_NULL_HANDLE;
    bool busy = false;
    std::vector<gpu::Buffer> captures;  ///< by captured output and lane
    uint32_t captured = 0;              ///< lanes that captures are of
    FrameTimes times;
  };
  struct Captured {
    std::string output;
    uint32_t resource = graph::kNone;
    bool previous = false;
    std::vector<image::Picture> pictures;  ///< by lane, filled anew for each frame
  };

  void makeSlots();
  void freeSlots();
  void makeTimers(size_t passes);
  void collect(Slot& slot);
  void record(Slot& slot, uint32_t slotIndex, const FrameInput& input, bool capture);
  const Storage& lastStorage(uint32_t resource, bool previous, uint32_t lane) const;
  const graph::GraphOutput& outputImage(const std::string& output) const;
  void recordCaptures(const Slot& slot, uint32_t parity) const;
  void deliver(Slot& slot);
  void notFromSink(const char* what) const;
  uint32_t resourceNamed(const std::string& name) const;
  void requireKept(const graph::Resource& resource, const std::string& name) const;
  std::vector<std::byte> download(const Storage& storage);

  const gpu::Device& device_;
  ExecutorOptions options_;
  Services services_;
  PipelineLibrary pipelines_;
  std::set<std::string> shaderFiles_;
  SceneFrame scene_;
  graph::CompiledGraph source_;  ///< as it was given, without what passes add
  std::unique_ptr<GraphRuntime> runtime_;
  std::array<Slot, kSlots> slots_;
  std::vector<Captured> captured_;
  LaneSink sink_;
  bool delivering_ = false;
  std::vector<uint64_t> ticks_;
  std::vector<FrameTimes> times_;  ///< a ring, allocated once
  size_t firstTime_ = 0, timesHeld_ = 0;
  uint64_t rays_ = 0;
};

}  // namespace weir::execute
