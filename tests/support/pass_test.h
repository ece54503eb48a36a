// One pass alone: a graph of a source, whose ports the test fills, and the pass under test.
//   PassTest t("restir_di.Temporal");
//   t.size(64, 64).scene(cornell()).param("mis", "biased").input("motion", motion);
//   t.run();
//   auto out = t.output<passes::Reservoir>("reservoirs");
#pragma once

#include <weir/execute/executor.h>
#include <weir/pass/plugin.h>

#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "support/device.h"

namespace weir::test {

class PassTest {
 public:
  explicit PassTest(std::string type);
  ~PassTest();

  // Before the first run().
  PassTest& size(uint32_t width, uint32_t height);
  PassTest& scene(scene::Scene scene);                   ///< default: an empty one
  PassTest& limits(const scene::PrepareLimits& limits);  ///< which meshes stay instances; default: prepareScene's own
  PassTest& clip(const std::string& name);               ///< of the scene, which that clip then moves
  /// Passes of the test's own, as a plugin would bring them.
  PassTest& plugin(const std::string& name, std::vector<WeirPassEntry> passes, const std::string& shaderFolder);
  PassTest& param(const std::string& name, const std::string& value);  ///< as after --set
  PassTest& count(const std::string& input, uint32_t perPixel);        ///< elements a pixel of an input that takes any
  PassTest& leaveOpen(const std::string& input);                       ///< an optional input that stays unconnected
  PassTest& backend(trace::Backend backend);                           ///< default: what the device prefers
  PassTest& withoutRayTracing();                                       ///< a device of its own with the features hidden
  /// Connects an input to one of the pass's own outputs of the last frame.
  PassTest& feedBack(const std::string& input, const std::string& output);

  // Any time: what the next frame finds. Unfilled inputs hold zeros.
  template <typename T>
  PassTest& input(const std::string& port, const std::vector<T>& values) {
    return inputBytes(port, std::as_bytes(std::span(values)));
  }
  PassTest& camera(const scene::Camera& camera);
  PassTest& at(double seconds);     ///< where in the clip the next frames are; before the first one: 0
  PassTest& frame(uint32_t index);  ///< number of the next frame; run() counts on from it
  PassTest& seed(uint32_t seed);
  void resetHistory();

  void run(uint32_t frames = 1);

  template <typename T>
  std::vector<T> output(const std::string& port) {
    const std::vector<std::byte> bytes = outputBytes(port);
    std::vector<T> values(bytes.size() / sizeof(T));
    std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
    return values;
  }

  const scene::PreparedScene& prepared();
  const scene::Scene& sourceScene() const { return scene_; }
  execute::FrameInput& next() { return frame_; }
  execute::Executor& executor();

 private:
  struct Machine;
  PassTest& inputBytes(const std::string& port, std::span<const std::byte> bytes);
  std::vector<std::byte> outputBytes(const std::string& port);
  void build();
  std::string json() const;

  std::string type_;
  uint32_t width_ = 64, height_ = 64;
  scene::Scene scene_;
  scene::PrepareLimits limits_;
  std::string clip_;
  double seconds_ = 0.0;
  struct OwnPlugin {
    std::string name, shaders;
    std::vector<WeirPassEntry> passes;
  };
  std::vector<OwnPlugin> plugins_;
  std::vector<std::string> sets_;
  std::map<std::string, uint32_t> counts_;
  std::vector<std::string> open_;
  std::map<std::string, std::string> feedBack_;
  std::optional<trace::Backend> backend_;
  bool hideRayTracing_ = false;
  std::map<std::string, std::vector<std::byte>> pending_;
  execute::FrameInput frame_;
  std::unique_ptr<Machine> machine_;
};

}  // namespace weir::test
