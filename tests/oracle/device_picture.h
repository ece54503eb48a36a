// Pictures by a graph on the device of the tests, restart by restart.
#pragma once

#include <weir/execute/executor.h>
#include <weir/graph/compile.h>
#include <weir/image/statistics.h>
#include <weir/pass/registry.h>
#include <weir/render/render.h>
#include <weir/render/stage.h>
#include <weir/trace/acceleration.h>

#include "support/device.h"

namespace weir::oracle {

class DevicePicture {
 public:
  explicit DevicePicture(const render::StageOptions& options)
      : device_(test::validatedDevice()),
        messages_(*device_),
        registry_(pluginSearchPath({})),
        stage_(render::makeStage(options, 1.0f)),
        scene_(*device_, stage_.scene, stage_.prepared, true) {}

  const render::Stage& stage() const { return stage_; }

  /// One frame a restart, each with cleared history and a seed of its own.
  image::RestartAccumulator render(const std::string& graph, const std::vector<std::string>& set, uint32_t side,
                                   uint32_t restarts, uint32_t tile) {
    graph::Overrides overrides;
    overrides.set = set;
    execute::Executor executor(
        *device_, compiler_, registry_, scene_,
        graph::compileFile(test::sourcePath("graphs/" + graph), overrides, registry_.catalog(), side, side),
        {.backend = trace::chooseBackend("auto", *device_)});
    render::Player player(stage_);
    image::RestartAccumulator result(tile);
    executor.captureTo({"radiance"}, [&](const std::string&, const image::Picture& p) { result.add(p); });
    for (uint32_t r = 0; r < restarts; ++r) {
      executor.resetHistory();
      executor.frame(player.frame(0, render::restartSeed(1, r)), true);
      executor.finish();
    }
    return result;
  }

 private:
  std::shared_ptr<gpu::Device> device_;
  test::ExpectNoValidationMessages messages_;
  Registry registry_;
  render::Stage stage_;
  scene::SceneGpu scene_;
  shader::Compiler compiler_;
};

}  // namespace weir::oracle
