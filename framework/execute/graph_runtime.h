// A compiled graph on a device: its memory, its passes, and the commands of a frame. Knows no queue: Executor submits
// frames of its own, an embedding host records them into its own command buffers.
#pragma once

#include <weir/execute/pass_runtime.h>
#include <weir/execute/scene_frame.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace weir::execute {

struct ExecutorOptions {
  trace::Backend backend = trace::Backend::None;
  bool countRays = false;   ///< an atomic add a ray: for statistics, not for timing
  std::string sceneFolder;  ///< what passes resolve relative files against
  bool shareMemory = true;  ///< transient resources that live at different times share memory
  bool poison = false;      ///< for tests: what is dead, or not yet written, is overwritten with rubbish
  /// Runs of the graph at a time, 1 … SceneFrame::kMostLanes, each with memory of its own. Where there is a SceneFrame
  /// already, it has said so.
  uint32_t lanes = 1;
};

/// Where the times of a frame go; all of it may be left out.
struct Stamps {
  VkQueryPool queries = VK_NULL_HANDLE;  ///< passes + 2: start, start of the first pass, end of each
  std::span<double> cpu;                 ///< milliseconds that recording each pass took
  uint32_t firstQuery = 0;               ///< where in the pool
};

class GraphRuntime {
 public:
  /// Compiles every shader and allocates everything, memory once for each of the scene's lanes. `services` and `scene`
  /// must outlive this. What is the same in `before` (history, pipelines) is taken over; `before` stays usable until
  /// then, so that a failure costs nothing. InputError when a graph that takes resources from its host is to have
  /// several lanes.
  GraphRuntime(const Services& services, SceneFrame& scene, graph::CompiledGraph graph, const ExecutorOptions& options,
               const GraphRuntime* before = nullptr);
  ~GraphRuntime();
  GraphRuntime(const GraphRuntime&) = delete;
  GraphRuntime& operator=(const GraphRuntime&) = delete;

  /// With scratch memory, places and barriers as they are on this device.
  const graph::CompiledGraph& graph() const { return graph_; }
  const Resources& resources(uint32_t lane = 0) const { return *lanes_[lane]; }

  /// Takes over the parameters of a graph that differs in nothing else, and in none that shaders are compiled with or
  /// that a pass looked at when it prepared. False when it does: then a new runtime is needed.
  bool update(const graph::CompiledGraph& graph);

  /// Puts the host's storage in the place of an external resource, for frames of one slot that are not in flight.
  /// InputError when there is no such resource.
  void setExternal(const std::string& name, uint32_t slot, Storage storage);

  /// InputError when one of the host's resources is missing for that slot. `record` asks first.
  void checkExternals(uint32_t slot) const;

  /// The commands of one frame. `slot` < SceneFrame::kSlots: the last frame recorded for it must be done.
  void record(VkCommandBuffer commands, const FrameInput& input, uint32_t slot, const Stamps& stamps);

  /// Whether a frame was recorded at all.
  bool recorded() const { return recorded_; }
  /// The stages that external resources are used in, for the host's own barriers.
  VkPipelineStageFlags2 stages() const;

 private:
  /// The barriers before a pass, ready to be recorded.
  struct Barriers {
    std::vector<VkMemoryBarrier2> memory;       ///< of all lanes at once
    std::vector<VkImageMemoryBarrier2> images;  ///< lane after lane, as many of each
  };
  void makeBarriers();
  bool hasFreshHistory() const;
  bool needsExternal(uint32_t resource) const;
  void clearHistory(VkCommandBuffer commands);
  void beforePass(VkCommandBuffer commands, size_t pass) const;
  void poisonAround(VkCommandBuffer commands, uint32_t pass, bool before) const;

  const gpu::Device& device_;
  SceneFrame& scene_;
  graph::CompiledGraph graph_;
  Shared shared_;
  std::vector<std::unique_ptr<Resources>> lanes_;
  std::vector<std::unique_ptr<PassRuntime>> passes_;
  std::vector<Barriers> barriers_;  ///< by pass
  bool share_, poison_, external_ = false, recorded_ = false;
};

}  // namespace weir::execute
