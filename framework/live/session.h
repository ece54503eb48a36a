// A graph that runs and follows its files: shaders, plugins and the graph's own JSON can be edited between two frames.
// Whatever goes wrong with an edit is reported, and what ran before goes on. The scene is never loaded again.
#pragma once

#include <weir/execute/executor.h>
#include <weir/graph/compile.h>
#include <weir/live/watched_files.h>
#include <weir/pass/registry.h>

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace weir::live {

/// What a session noticed. All that changed since the last look takes effect together, or nothing of it but the
/// plugins: then each event has the error.
struct Event {
  enum class Kind : uint8_t { Graph, Plugin, Shader };
  Kind kind = Kind::Graph;
  std::vector<std::string> files;  ///< that changed
  std::string error;               ///< complete, with places; empty: the change is in force
};

class Session {
 public:
  /// Reads and compiles the graph file. Throws as compileFile and Executor do. The references must outlive the session.
  Session(const gpu::Device& device, shader::Compiler& compiler, Registry& registry, const scene::SceneGpu& scene,
          const std::string& graphFile, const graph::Overrides& overrides, const graph::CompileOptions& compileOptions,
          const execute::ExecutorOptions& executorOptions);

  /// The same with a graph that is edited, as by edit().
  Session(const gpu::Device& device, shader::Compiler& compiler, Registry& registry, const scene::SceneGpu& scene,
          const std::string& graphFile, const std::string& json, const graph::CompileOptions& compileOptions,
          const execute::ExecutorOptions& executorOptions);

  execute::Executor& executor() { return *executor_; }
  const execute::Executor& executor() const { return *executor_; }
  const graph::Overrides& overrides() const { return overrides_; }

  /// Looks whether files changed and follows them. Between two frames.
  std::vector<Event> poll();

  /// `--set`, `--enable`, `--disable` and the frame's size from now on; history is kept as Executor::swap says. When it
  /// throws (GraphError, shader::CompileError, …) nothing has changed.
  void change(const graph::Overrides& overrides, const graph::CompileOptions& compileOptions);

  /// The graph is this JSON from now on and no longer what its file says; the file stands for it in messages. Then a
  /// change of the file is an event without an error that changes nothing: whoever edits decides. As change()
  /// otherwise.
  void edit(const std::string& json, const graph::CompileOptions& compileOptions);

 private:
  graph::CompiledGraph compile(const graph::Overrides& overrides, const graph::CompileOptions& options) const;
  std::vector<std::string> typesNamed() const;
  void watch(WatchedFiles::Moment before);
  const std::set<std::string>& plugins();
  std::vector<std::string> filesOf(const std::string& plugin) const;

  Registry& registry_;
  std::string graphFile_;
  std::optional<std::string> json_;  ///< of the graph, when it is edited
  graph::Overrides overrides_;
  graph::CompileOptions options_;
  std::unique_ptr<execute::Executor> executor_;
  WatchedFiles files_;
  std::set<std::string> plugins_;  ///< that were looked at so far
  bool shadersPending_ = false;    ///< edited, and not in force yet
};

}  // namespace weir::live
