// Graphs that are run restart by restart over one scene on one device: what statistics are made of.
#pragma once

#include <weir/execute/executor.h>
#include <weir/graph/compile.h>
#include <weir/pass/registry.h>
#include <weir/render/mean.h>
#include <weir/render/stage.h>

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace weir::render {

struct DeviceChoice {
  std::string device;          ///< as `--device`
  std::string trace = "auto";  ///< as `--trace`
  bool validation = false;
};

/// Plugins first, scene and device later: what can be said of graphs is said before a scene is read.
class Laboratory {
 public:
  explicit Laboratory(const std::vector<std::string>& pluginPaths);
  /// Throws graph::GraphError.
  graph::CompiledGraph compile(const std::string& file, const graph::Overrides& overrides, uint32_t width,
                               uint32_t height);
  /// Reads and uploads. Throws InputError, RuntimeError. Another stage may follow, on the device of the first call; no
  /// executor may live on then.
  void open(const StageOptions& stage, const DeviceChoice& choice, float aspect);

  const Stage& stage() const { return *stage_; }
  const gpu::Device& device() const { return *device_; }
  trace::Backend backend() const { return backend_; }
  Registry& registry() { return registry_; }
  uint64_t sceneBytes() const { return scene_->bytes(); }
  /// Throws RuntimeError with what the validation layers have said so far.
  void requireNoValidationMessages() const;
  /// `lanes`, `countRays`: as in execute::ExecutorOptions.
  std::unique_ptr<execute::Executor> executor(graph::CompiledGraph graph, uint32_t lanes = 1, bool countRays = false);

 private:
  Registry registry_;
  std::optional<Stage> stage_;
  std::string sceneFolder_;
  std::unique_ptr<gpu::Device> device_;
  trace::Backend backend_ = trace::Backend::None;
  std::unique_ptr<scene::SceneGpu> scene_;
  shader::Compiler compiler_;
};

struct RestartOptions {
  std::string output = "radiance";
  uint32_t frames = 1;      ///< of a restart
  uint32_t firstFrame = 0;  ///< number of the first one
  uint32_t seed = 0;
  /// The last frame alone, as where a clip moves the scene and no two frames show the same; else the mean of all.
  bool lastOnly = false;
  /// Restarts that run at a time, 1 … execute::SceneFrame::kMostLanes, each with memory of its own; 0: as lanesThatFill
  /// says. Pictures are the same, whatever it is.
  uint32_t lanes = 0;
};

/// Independent restarts of a graph, one picture each, several at a time in the lanes of one executor. Nothing waits for
/// a restart's end but the last one's.
class Restarts {
 public:
  /// The laboratory must outlive this, and be open. Throws InputError when there is no such picture among the outputs,
  /// or no such number of lanes; RuntimeError when memory does not suffice.
  Restarts(Laboratory& laboratory, graph::CompiledGraph graph, const RestartOptions& options);
  Restarts(const Restarts&) = delete;
  Restarts& operator=(const Restarts&) = delete;
  /// Is given the pictures of restarts that ran at a time, in order.
  using Sink = std::function<void(std::span<const image::Picture>)>;
  /// So many more, in order, each with a seed of its own and cleared history.
  void run(uint32_t count, const Sink& sink);
  uint32_t done() const { return done_; }
  uint32_t lanes() const { return lanes_; }
  execute::Executor& executor() { return *executor_; }

 private:
  void take(std::span<const image::Picture> lanes);

  RestartOptions options_;
  uint32_t lanes_;
  std::unique_ptr<execute::Executor> executor_;
  Player player_;
  uint32_t done_ = 0, delivered_ = 0;
  std::vector<uint32_t> seeds_;   ///< of the restarts that run now
  std::vector<FrameMean> means_;  ///< by lane
  const Sink* sink_ = nullptr;
};

/// A graph that comes with Weir, such as "reference.json": in `graphs` beside the program, or where an installation has
/// it. InputError when it isn't there.
std::string bundledGraph(const std::string& name);

}  // namespace weir::render
