// A known bug against a test that should notice: renders a situation by a graph that may have a bug in it, many times
// with independent seeds, and holds the mean against what the situation's reference says.
#pragma once

#include <weir/execute/executor.h>
#include <weir/gpu/device.h>
#include <weir/image/verdict.h>
#include <weir/pass/registry.h>
#include <weir/render/stage.h>
#include <weir/scene/upload.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace weir::test {

/// Chance of a false alarm in one examination. A hundred clean seeds of twenty situations then raise 0.4 alarms on
/// average, more than one in six cases of a hundred.
inline constexpr double kAlpha = 2e-4;

/// Something to look at, the graph that is under test, and the graph that says what is right.
struct Situation {
  std::string name;
  std::string about;
  std::function<render::Stage()> stage;
  std::string graph = "graphs/restir_di.json";
  std::vector<std::string> set = {}, disable = {};
  uint32_t frames = 4;  ///< of a restart; in a still scene their mean is its sample, in one that moves the last of them
  uint32_t restarts = 64;  ///< enough for the quick run to find what this situation is there for
  std::string reference = "graphs/all_lights.json";
  std::vector<std::string> referenceSet = {"direct.samples=4"};
  uint32_t referenceRestarts = 32;
  /// The camera of a frame; empty: the stage's. Where it is given, the camera moves, and only the last frame counts.
  std::function<scene::Camera(uint32_t frame)> camera = {};
  uint32_t size = 64;  ///< pixels a side
};

/// A bug. Either one that shaders have under WEIR_MUTANT (shaders/common/mutants.glsl), or one in what the host
/// prepares.
struct Mutant {
  int number = 0;         ///< of WEIR_MUTANT; host bugs count on from 100
  std::string bug;        ///< what is wrong
  std::string situation;  ///< that shows it
  std::function<void(scene::PreparedScene&)> host = {};
  bool quick = false;  ///< part of ./test.sh
};

struct Finding {
  bool caught = false;                         ///< the verdict is "biased"
  double relativeBias = 0, low = 0, high = 0;  ///< of the whole picture, at the test's own confidence
  double worstT = 0, bound = 0;                ///< of the fine tiles
  double seconds = 0;
};

/// One situation on a device, with its reference.
class Laboratory {
 public:
  /// `effort` multiplies the restarts of graph and reference. Chance of a false alarm in one examine(): `alpha`.
  Laboratory(const gpu::Device& device, const Situation& situation, double effort, double alpha);
  ~Laboratory();
  Laboratory(const Laboratory&) = delete;
  Laboratory& operator=(const Laboratory&) = delete;

  /// `mutant` null: everything as it should be.
  Finding examine(const Mutant* mutant, uint32_t seed);
  /// What is compared with is rendered anew, by other random numbers. The first one is there from the start.
  void renderReference(uint32_t seed);
  const Situation& situation() const { return situation_; }

 private:
  struct Words {
    const std::string& graph;
    const std::vector<std::string>&set, &disable;
    uint32_t restarts, frames, firstFrame, seed;
  };
  std::unique_ptr<execute::Executor> executor(const Words& words, const scene::SceneGpu& scene,
                                              shader::Compiler& compiler);
  image::EvidenceCollector run(execute::Executor& executor, const Words& words, const render::Stage& stage);

  const gpu::Device& device_;
  Situation situation_;
  double effort_, alpha_;
  Registry registry_;
  render::Stage stage_;
  std::unique_ptr<scene::SceneGpu> scene_;
  image::Evidence truth_;
  shader::Compiler compiler_;                             ///< of everything without a bug
  std::unique_ptr<execute::Executor> reference_, clean_;  ///< made once: many clean runs are asked for
};

/// All situations, and all bugs in the order of their numbers.
const std::vector<Situation>& situations();
const std::vector<Mutant>& mutants();
/// InputError with the nearest name when there is none.
const Situation& situationNamed(const std::string& name);

}  // namespace weir::test
