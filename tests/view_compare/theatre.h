// A scene on the tests' device with what graphs need to run over it, under validation.
#pragma once

#include <gtest/gtest.h>
#include <weir/execute/executor.h>
#include <weir/graph/compile.h>
#include <weir/pass/plugin_loader.h>
#include <weir/pass/registry.h>
#include <weir/render/stage.h>
#include <weir/trace/acceleration.h>

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "support/device.h"
#include "view/compare/background_reference.h"

namespace weir::test {

class Theatre : public ::testing::Test {
 protected:
  explicit Theatre(const render::StageOptions& options = {.scene = sourcePath("scenes/cornell.glb")})
      : stage_(render::makeStage(options, 1.0f)),
        scene_(*device_, stage_.scene, stage_.prepared, device_->capabilities().accelerationStructure) {
    executorOptions_.backend = trace::chooseBackend("auto", *device_);
    shown_.camera = stage_.camera;
  }

  view::ReferenceServices services() { return {*device_, compiler_, registry_, scene_, executorOptions_}; }
  view::BackgroundReference reference(const view::ReferenceGraph& graph, uint32_t side = kSide) {
    return {services(), graph, shown_, side, side};
  }
  static view::ReferenceGraph graph(const std::string& name, uint32_t shownSeed = 0) {
    return {sourcePath("graphs/" + name), {}, "radiance", shownSeed};
  }

  /// An executor of a graph, as the window has one.
  std::unique_ptr<execute::Executor> executor(const std::string& name, uint32_t side = kSide) {
    graph::CompiledGraph compiled =
        graph::compileFile(sourcePath("graphs/" + name), {}, registry_.catalog(), side, side);
    return std::make_unique<execute::Executor>(*device_, compiler_, registry_, scene_, std::move(compiled),
                                               executorOptions_);
  }
  /// The frames that a reference with this seed is made of, one by one.
  std::vector<image::Picture> frames(const std::string& name, uint32_t seed, uint32_t count, bool cut = false,
                                     uint32_t side = kSide) {
    const std::unique_ptr<execute::Executor> own = executor(name, side);
    std::vector<image::Picture> pictures;
    for (uint32_t f = 0; f < count; ++f) {
      execute::FrameInput input = shown_;
      input.index = f;
      input.seed = seed;
      input.cut = cut;
      own->frame(input);
      pictures.push_back(own->read("radiance"));
    }
    return pictures;
  }

  /// Less than a frame takes: it has one frame at most.
  static uint32_t smallStep(view::BackgroundReference& reference) {
    return reference.step(0.5 * reference.frameMilliseconds().value_or(1.0));
  }
  /// Steps until so many frames are submitted.
  static void advance(view::BackgroundReference& reference, uint32_t frames) {
    for (uint32_t done = 0; done < frames; std::this_thread::sleep_for(std::chrono::milliseconds(1)))
      done += smallStep(reference);
  }
  image::Picture read(const execute::Executor::Located& image) {
    view::PictureRing ring(*device_);
    EXPECT_TRUE(ring.capture(image, 0));
    device_->waitIdle();
    return ring.take().at(0).picture();
  }
  static bool eventually(const std::function<bool()>& holds) {
    for (int i = 0; i < 30000; ++i) {
      if (holds()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return false;
  }

  static constexpr uint32_t kSide = 32;
  std::shared_ptr<gpu::Device> device_ = validatedDevice();
  ExpectNoValidationMessages guard_{*device_};
  shader::Compiler compiler_;
  Registry registry_{pluginSearchPath({})};
  render::Stage stage_;
  scene::SceneGpu scene_;
  execute::ExecutorOptions executorOptions_;
  execute::FrameInput shown_;
};

}  // namespace weir::test
