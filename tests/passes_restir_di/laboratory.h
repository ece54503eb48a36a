// Whole graphs over a scene that a test builds, against brute force: one picture a restart, means of tiles.
#pragma once

#include <weir/graph/compile.h>
#include <weir/image/statistics.h>
#include <weir/pass/registry.h>
#include <weir/render/mean.h>
#include <weir/render/render.h>
#include <weir/trace/acceleration.h>

#include <filesystem>
#include <string>
#include <vector>

#include "support/device.h"
#include "support/pass_test.h"

namespace weir::test {

/// A graph with settings and passes left out, and how often and how long it runs.
struct Protocol {
  std::string graph = "graphs/restir_di.json";
  std::vector<std::string> set, disable;
  uint32_t restarts = 32;
  uint32_t frames = 4;  ///< a restart's picture is their mean
  uint32_t seed = 7;
};

class Laboratory {
 public:
  /// Pictures of side² pixels from the scene's first camera, and tiles of tile².
  Laboratory(scene::Scene scene, uint32_t side, uint32_t tile)
      : side_(side),
        tile_(tile),
        device_(validatedDevice()),
        guard_(*device_),
        registry_({std::filesystem::path(binaryPath("bin"))}),
        scene_(std::move(scene)),
        prepared_(scene::prepareScene(scene_)),
        gpu_(*device_, scene_, prepared_, device_->capabilities().accelerationStructure) {}

  image::RestartAccumulator run(const Protocol& p) {
    execute::Executor executor(
        *device_, compiler_, registry_, gpu_,
        graph::compileFile(sourcePath(p.graph), {.set = p.set, .enable = {}, .disable = p.disable}, registry_.catalog(),
                           side_, side_),
        {.backend = trace::chooseBackend("auto", *device_)});
    image::RestartAccumulator result(tile_);
    for (uint32_t r = 0; r < p.restarts; ++r) {
      executor.resetHistory();
      render::FrameMean mean;
      for (uint32_t f = 0; f < p.frames; ++f) {
        executor.frame({scene_.cameras.front(), f, render::restartSeed(p.seed, r), false});
        mean.add(executor.read("radiance"));
      }
      result.add(mean.mean());
    }
    EXPECT_EQ(result.nonFinite(), 0u);
    return result;
  }

  /// reference.AllLights with so many strata a side; every frame has its own jitter.
  void measureTruth(const std::string& samples, uint32_t restarts, uint32_t frames) {
    const image::RestartAccumulator reference = run({.graph = "graphs/all_lights.json",
                                                     .set = {"direct.samples=" + samples, "gbuffer.jitter=true"},
                                                     .restarts = restarts,
                                                     .frames = frames,
                                                     .seed = 1000});
    truth_ = reference.mean();
    truthError_ = reference.standardError();
  }
  image::TileTest test(const Protocol& p, double alpha) {
    return image::tileTest(run(p).tiles(), truth_, &truthError_, {.alpha = alpha});
  }

 private:
  uint32_t side_, tile_;
  std::shared_ptr<gpu::Device> device_;
  ExpectNoValidationMessages guard_;
  Registry registry_;
  scene::Scene scene_;
  scene::PreparedScene prepared_;
  scene::SceneGpu gpu_;
  shader::Compiler compiler_;
  image::Picture truth_, truthError_;
};

/// Every tile and the mean within their bounds, and the mean's interval narrower than `resolved`.
inline void expectAgreement(const image::TileTest& t, double resolved) {
  EXPECT_TRUE(t.passed) << "worst |t| " << t.worstT << ", bound " << t.bound << ", tile " << t.worst << ": "
                        << t.tiles[t.worst].relativeBias;
  EXPECT_LE(t.intervalLow, 0.0);
  EXPECT_GE(t.intervalHigh, 0.0);
  EXPECT_LT(t.intervalHigh - t.intervalLow, resolved) << "too few samples to find anything";
}

}  // namespace weir::test
