// The whole graph over real scenes: restir_di with the unbiased settings against brute force, tile by tile.
#include <gtest/gtest.h>
#include <weir/graph/compile.h>
#include <weir/image/statistics.h>
#include <weir/pass/registry.h>
#include <weir/render/mean.h>
#include <weir/render/render.h>
#include <weir/trace/acceleration.h>

#include <filesystem>

#include "support/device.h"
#include "support/pass_test.h"

namespace weir::test {
namespace {

constexpr uint32_t kSide = 64, kTile = 16;

class Laboratory {
 public:
  Laboratory(const std::string& sceneFile, const std::string& environment)
      : device_(validatedDevice()),
        guard_(*device_),
        registry_({std::filesystem::path(binaryPath("bin"))}),
        stage_(render::makeStage(
            {.scene = sourcePath(sceneFile), .environment = environment.empty() ? "" : sourcePath(environment)}, 1.0f)),
        scene_(*device_, stage_.scene, stage_.prepared, device_->capabilities().accelerationStructure) {}

  /// One picture a restart: the mean of its frames.
  image::RestartAccumulator run(const std::string& graph, const graph::Overrides& overrides, uint32_t restarts,
                                uint32_t frames, uint32_t seed) {
    execute::Executor executor(*device_, compiler_, registry_, scene_,
                               graph::compileFile(sourcePath(graph), overrides, registry_.catalog(), kSide, kSide),
                               {.backend = trace::chooseBackend("auto", *device_)});
    image::RestartAccumulator result(kTile);
    for (uint32_t r = 0; r < restarts; ++r) {
      executor.resetHistory();
      render::FrameMean mean;
      for (uint32_t f = 0; f < frames; ++f) {
        executor.frame({stage_.camera, f, render::restartSeed(seed, r), false});
        mean.add(executor.read("radiance"));
      }
      result.add(mean.mean());
    }
    return result;
  }

 private:
  std::shared_ptr<gpu::Device> device_;
  ExpectNoValidationMessages guard_;
  Registry registry_;
  render::Stage stage_;
  scene::SceneGpu scene_;
  shader::Compiler compiler_;
};

/// Tiles within Student's bound and the whole picture's bias within its interval. Chance of a false alarm of one
/// scene's test: 1e-3 for the tiles of its four settings together, and as much for the four means.
void expectUnbiased(const std::string& scene, uint32_t referenceRestarts, const std::string& referenceSamples,
                    const std::string& candidates, const std::string& environment = "", double detectable = 0.03,
                    const std::string& tiles = "auto") {
  Laboratory laboratory(scene, environment);
  const image::RestartAccumulator reference = laboratory.run(
      "graphs/all_lights.json", {.set = {"direct.samples=" + referenceSamples}, .enable = {}, .disable = {}},
      referenceRestarts, 1, 1000);
  const image::Picture truth = reference.mean(), truthError = reference.standardError();
  const struct {
    const char* name;
    std::vector<std::string> disable;
    uint32_t frames;  ///< past the first they exercise the history
  } settings[] = {{"no reuse", {"temporal", "spatial"}, 2},
                  {"temporal", {"spatial"}, 5},
                  {"spatial", {"temporal"}, 2},
                  {"both", {}, 5}};
  for (const auto& s : settings) {
    SCOPED_TRACE(s.name);
    const graph::Overrides overrides{
        .set = {"initial.candidates=" + candidates, "initial.tiles=" + tiles, "temporal.visibilityRays=true",
                "spatial.visibilityRays=true", "temporal.confidenceCap=4", "spatial.radius=12"},
        .enable = {},
        .disable = s.disable};
    const image::RestartAccumulator measured = laboratory.run("graphs/restir_di.json", overrides, 24, s.frames, 7);
    EXPECT_EQ(measured.nonFinite(), 0u);
    const image::TileTest t = image::tileTest(measured.tiles(), truth, &truthError, {.alpha = 1e-3 / 4});
    EXPECT_EQ(t.tiles.size(), 16u);
    EXPECT_TRUE(t.passed) << "worst |t| " << t.worstT << ", bound " << t.bound << ", tile " << t.worst << ": "
                          << t.tiles[t.worst].relativeBias;
    EXPECT_LE(t.intervalLow, 0.0);
    EXPECT_GE(t.intervalHigh, 0.0);
    // What could have been found: a bias of so much in one tile (three percent), or of a third of it in the picture.
    EXPECT_LT(t.detectable, detectable);
    EXPECT_LT(t.intervalHigh - t.intervalLow, detectable * 2 / 3);
  }
}

TEST(RestirEndToEnd, CornellBox) {
  expectUnbiased("scenes/cornell.glb", 24, "4", "8");
}
TEST(RestirEndToEnd, ThousandPoints) {
  // Each pixel by itself: with picks shared by 256 pixels the means of so small tiles vary three times as much, and
  // this test wants to find three percent. RestirTiles has the tiles.
  expectUnbiased("scenes/cornell-1000-points.glb", 3, "1", "128", "", 0.03, "off");
}

// The lamp and the sky that comes in at the open front.
TEST(RestirEndToEnd, CornellBoxUnderTheSky) {
  expectUnbiased("scenes/cornell.glb", 24, "4", "32", "scenes/sky.hdr", 0.06);
}

}  // namespace
}  // namespace weir::test
