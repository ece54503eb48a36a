// Independent restarts of a whole graph over a scene that was built in memory.
#pragma once

#include <weir/execute/executor.h>
#include <weir/graph/compile.h>
#include <weir/image/statistics.h>
#include <weir/pass/registry.h>
#include <weir/render/mean.h>
#include <weir/render/render.h>
#include <weir/trace/acceleration.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "support/device.h"

namespace weir::test {

/// Passes and compiled shaders, shared by every scene of a test program; any validation message fails the test that
/// holds it.
class Workshop {
 public:
  Workshop() : device_(validatedDevice()), guard_(*device_), registry_({std::filesystem::path(binaryPath("bin"))}) {}
  gpu::Device& device() { return *device_; }
  Registry& registry() { return registry_; }
  shader::Compiler& compiler() { return compiler_; }

 private:
  std::shared_ptr<gpu::Device> device_;
  ExpectNoValidationMessages guard_;
  Registry registry_;
  shader::Compiler compiler_;
};

/// How often and with what a graph runs.
struct Plan {
  std::string graph;             ///< file in the source tree
  std::vector<std::string> set;  ///< as after --set
  uint32_t restarts = 1, frames = 1, seed = 1;
  uint32_t side = 16;  ///< pixels, of a square picture
};

/// A scene on the device, as one camera sees it.
class Setting {
 public:
  Setting(Workshop& workshop, scene::Scene scene, const scene::Camera& camera)
      : workshop_(workshop),
        scene_(std::move(scene)),
        camera_(camera),
        prepared_(scene::prepareScene(scene_)),
        onDevice_(workshop.device(), scene_, prepared_, workshop.device().capabilities().accelerationStructure) {}

  /// Calls use(picture) with the mean over frames of every restart's output "radiance".
  void run(const Plan& plan, const std::function<void(const image::Picture&)>& use) {
    const graph::Overrides overrides{.set = plan.set, .enable = {}, .disable = {}};
    execute::Executor executor(
        workshop_.device(), workshop_.compiler(), workshop_.registry(), onDevice_,
        graph::compileFile(sourcePath(plan.graph), overrides, workshop_.registry().catalog(), plan.side, plan.side),
        {.backend = trace::chooseBackend("auto", workshop_.device())});
    for (uint32_t r = 0; r < plan.restarts; ++r) {
      executor.resetHistory();
      render::FrameMean mean;
      executor.captureTo({"radiance"}, [&](const std::string&, const image::Picture& p) { mean.add(p); });
      for (uint32_t f = 0; f < plan.frames; ++f) {
        executor.frame({camera_, f, render::restartSeed(plan.seed, r), false}, true);
      }
      executor.finish();
      use(mean.mean());
    }
  }

  const scene::Camera& camera() const { return camera_; }

 private:
  Workshop& workshop_;
  scene::Scene scene_;
  scene::Camera camera_;
  scene::PreparedScene prepared_;
  scene::SceneGpu onDevice_;
};

}  // namespace weir::test
