// A reference that grows while the window goes on: a graph over the same scene with an executor of its own, a few
// frames at a time, summed up on the device.
#pragma once

#include <weir/execute/executor.h>
#include <weir/graph/compile.h>
#include <weir/pass/registry.h>
#include <weir/scene/scene_state.h>

#include <array>
#include <memory>
#include <optional>
#include <string>

#include "view/compare/accumulator.h"
#include "view/compare/background_worker.h"
#include "view/compare/frame_pacer.h"
#include "view/compare/picture_ring.h"
#include "view/compare/reference.h"
#include "view/compare/submission.h"

namespace weir::view {

/// All must outlive the reference.
struct ReferenceServices {
  const gpu::Device& device;
  shader::Compiler& compiler;
  Registry& registry;
  const scene::SceneGpu& scene;
  execute::ExecutorOptions options;  ///< as the shown graph's; one lane, rays uncounted, whatever it says
};

struct ReferenceGraph {
  std::string file;  ///< such as graphs/all_lights.json for direct light, graphs/reference.json for all of it
  graph::Overrides overrides;
  std::string output = "radiance";
  uint32_t shownSeed = 0;  ///< of the shown graph: the reference has another, so that the two are independent
};

class BackgroundReference final : public Reference {
 public:
  /// Compiles and allocates. Throws as graph::compileFile and execute::Executor do, and InputError when the graph has
  /// no such output or it is no picture.
  BackgroundReference(const ReferenceServices& services, const ReferenceGraph& graph, const execute::FrameInput& shown,
                      uint32_t width, uint32_t height);
  ~BackgroundReference() override;
  BackgroundReference(const BackgroundReference&) = delete;
  BackgroundReference& operator=(const BackgroundReference&) = delete;

  void restart(const execute::FrameInput& shown, uint32_t width, uint32_t height) override;
  /// Reads the graph and its shaders anew, after edits, and starts over. When it throws, the old ones go on.
  void reload();
  uint32_t step(double budgetMilliseconds) override;
  std::optional<execute::Executor::Located> image() const override;
  std::shared_ptr<const ReferencePicture> latest() const override;
  uint64_t view() const override { return view_; }
  std::string words() const override;
  std::string warning() const override;

  /// Submitted so far of this view.
  uint32_t frames() const { return frames_; }
  uint32_t seed() const { return seed_; }
  /// What a frame takes on the device, with adding it; none: unknown, or the device measures no time.
  std::optional<double> frameMilliseconds() const { return pacer_.cost(); }
  uint64_t bytes() const;  ///< of device memory, without the scene

 private:
  /// Frames in flight: as many as the executor's, so that submitting one never waits within it.
  static constexpr uint32_t kSlots = execute::SceneFrame::kSlots;
  struct Slot;
  /// What the worker leaves behind.
  struct Host;

  graph::CompiledGraph compile(uint32_t width, uint32_t height) const;
  std::unique_ptr<Accumulator> makeAccumulator(const graph::CompiledGraph& graph) const;
  void keepShown(const execute::FrameInput& shown);
  void startOver();
  void drain();
  void submitFrame(uint32_t slot);
  void readTimes(Slot& slot);
  void bringToHost();

  ReferenceServices services_;
  ReferenceGraph graph_;
  uint32_t seed_;
  scene::Camera camera_;
  std::optional<scene::SceneState> state_;
  uint32_t width_, height_;
  bool remembers_ = false;  ///< the graph has history
  uint64_t view_ = 1;
  uint32_t frames_ = 0, nextCopy_ = 1;
  FramePacer pacer_;
  double addingMilliseconds_ = 0.0;
  std::unique_ptr<execute::Executor> executor_;
  std::unique_ptr<Accumulator> accumulator_;
  std::array<std::unique_ptr<Slot>, kSlots> slots_;
  uint32_t nextSlot_ = 0;
  PictureRing ring_;
  std::shared_ptr<Host> host_;
  BackgroundWorker worker_;
};

}  // namespace weir::view
