// What runs in the window: a scene, the graph over it, frame after frame, and beside it a second graph to compare with.
// Everything that can go wrong throws, and then what ran before goes on.
#pragma once

#include <weir/gpu/device.h>
#include <weir/live/session.h>
#include <weir/render/stage.h>
#include <weir/scene/upload.h>
#include <weir/shader/compiler.h>

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace weir::view {

struct EngineOptions {
  std::string graphFile;  ///< stands for the graph in messages, and is watched
  std::string graphJson;  ///< what runs
  glm::uvec2 size{1280, 720};
  uint32_t seed = 0, firstFrame = 0;
  trace::Backend backend = trace::Backend::None;
};

/// A loaded scene on the device, with what plays it.
struct Staged {
  render::StageOptions options;
  std::unique_ptr<render::Stage> stage;
  std::unique_ptr<scene::SceneGpu> gpu;
  std::unique_ptr<render::Player> player;
};

class Engine {
 public:
  /// Uploads the scene and compiles the graph. Throws as render::render does. The references must outlive it.
  Engine(const gpu::Device& device, Registry& registry, const EngineOptions& options,
         const render::StageOptions& stageOptions, std::unique_ptr<render::Stage> stage);
  ~Engine();
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  // ------------------------------------------------------------------------------------------------- graph
  /// Goes on with this graph. `file` where it is another one than before.
  void setGraph(const std::string& json);
  void openGraph(const std::string& file, const std::string& json);
  /// Of the pictures, from the next frame on.
  void setSize(glm::uvec2 size);
  glm::uvec2 size() const { return {compile_.width, compile_.height}; }
  /// These ports, "pass.port", stay readable to the frame's end; of those that the graph does not have nothing comes.
  void keep(const std::vector<std::string>& ports);
  /// Counts rays with an atomic add each, which costs time.
  void countRays(bool count);
  bool countsRays() const { return countRays_; }
  execute::Executor& executor() { return session_->executor(); }
  /// For other executors over the same scene.
  execute::ExecutorOptions executorOptions() const { return executorOptions(staged_); }
  const graph::CompiledGraph& graph() const { return session_->executor().graph(); }

  /// A second graph over the same scene, with the same frames; none when `file` is empty.
  void openSecond(const std::string& file);
  execute::Executor* second() { return second_ ? &second_->executor() : nullptr; }
  const std::string& secondFile() const { return secondFile_; }
  void keepOfSecond(const std::vector<std::string>& ports);

  /// Looks at the files; see live::Session::poll().
  std::vector<live::Event> poll();

  // ------------------------------------------------------------------------------------------------- scene
  const render::Stage& stage() const { return *staged_.stage; }
  const render::StageOptions& stageOptions() const { return staged_.options; }
  const scene::SceneGpu& sceneGpu() const { return *staged_.gpu; }
  /// Another scene under the same graphs. Time begins anew.
  void setStage(const render::StageOptions& options, std::unique_ptr<render::Stage> stage);
  /// A punctual light of the scene, by its index in Scene::lights, moved or in another colour. Pictures of before and
  /// after mix in the history for as long as it lasts. Its scene is told apart from the file's: lightsEdited().
  void setLight(size_t index, const scene::PunctualLight& light);
  /// Whether that light stays where the user puts it: a clip may move it.
  bool canMove(size_t light) const;
  bool lightsEdited() const { return lightsEdited_; }

  // -------------------------------------------------------------------------------------------------- time
  /// Renders the next frame of the graphs, if there is one to be. False when paused.
  /// `camera` where the scene's own, setSceneCamera()'s, is not meant: that goes where a clip takes it.
  bool advance(const std::optional<scene::Camera>& camera);
  void setSceneCamera(const scene::Camera& camera) { staged_.stage->camera = camera; }
  bool paused() const { return paused_; }
  void setPaused(bool paused);
  /// One frame more, then paused.
  void step();
  /// From the first frame on, without history.
  void restart();
  /// The same, and paused after so many frames.
  void runFrames(uint32_t frames);
  /// Frames since the last restart: the last one had the number firstFrame() + frames() - 1.
  uint32_t frames() const { return frames_; }
  uint32_t firstFrame() const { return firstFrame_; }
  uint32_t seed() const { return seed_; }
  /// Animation, where the scene has been loaded with one: seconds, and whether it goes on.
  double seconds() const { return seconds_; }            ///< of the next frame
  double shownSeconds() const { return shownSeconds_; }  ///< of the last one
  void setSeconds(double seconds);
  bool plays() const { return plays_; }
  void setPlays(bool plays) { plays_ = plays; }
  /// What was shown last; for a reference that must see the same.
  execute::FrameInput lastInput() const { return lastInput_; }
  /// Another number for another scene or other lights.
  uint64_t sceneRevision() const { return sceneRevision_; }

 private:
  execute::ExecutorOptions executorOptions(const Staged& staged) const;
  std::unique_ptr<live::Session> makeSession(const Staged& staged, const std::string& file, const std::string* json,
                                             const graph::CompileOptions& compile) const;
  Staged upload(const render::StageOptions& options, std::unique_ptr<render::Stage> stage) const;
  graph::CompileOptions keeping(const std::vector<std::string>& ports, const std::string& json) const;

  const gpu::Device& device_;
  Registry& registry_;
  trace::Backend backend_;
  mutable shader::Compiler compiler_;
  Staged staged_;
  std::string graphFile_, graphJson_, secondFile_;
  graph::CompileOptions compile_, secondCompile_;
  std::vector<std::string> kept_;
  std::unique_ptr<live::Session> session_, second_;
  bool countRays_ = false, lightsEdited_ = false;
  uint32_t seed_, firstFrame_, frames_ = 0;
  bool paused_ = false, plays_ = true;
  std::optional<uint32_t> left_;  ///< frames to go of a run until it pauses
  uint32_t run_ = 0;              ///< how many that were
  bool steps_ = false;            ///< one frame, then pause
  double seconds_ = 0.0, shownSeconds_ = 0.0;
  execute::FrameInput lastInput_;
  uint64_t sceneRevision_ = 1;
};

}  // namespace weir::view
