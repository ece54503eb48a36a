// Tiles of restir_di.Initial: as unbiased as the whole table, whatever kinds of lights, and the same from
// run to run.
#include <gtest/gtest.h>

#include <cstring>

#include "laboratory.h"
#include "setup.h"
#include "support/environment_oracle.h"
#include "support/small_scenes.h"

namespace weir::test {
namespace {

using passes::Reservoir;

constexpr uint32_t kSide = 32;

/// Of colours that eight bits to a brightest part hold badly: what is rounded away entirely would be lost.
scene::Scene colouredPoints() {
  return pointScene({{{-1.5f, 1, 1}, {3, 0.001f, 0.2f}},
                     {{1, 0.5f, 1.5f}, {0.01f, 4, 0.02f}},
                     {{0, -1.5f, 1}, {0.5f, 0.4f, 60}},
                     {{1.7f, 1.7f, 0.6f}, {0.02f, 0.015f, 0.01f}},
                     {{-1, -1, 3}, {6, 6, 5}}});
}

// The mean of f · W over pixels, frames and seeds is the sum over all lights. Pixels of a block share a tile, so that
// only the means of whole frames are independent. Chance of a false alarm: 1e-4 for each call.
void expectUnbiased(const scene::Scene& scene, const char* picks, double resolved) {
  const View view = planeView(kSide, kSide, frontCamera());
  struct Run {
    int candidates, samples, frames;
  };
  const Run runs[] = {{1, 1, 48}, {3, 2, 32}, {32, 1, 16}, {48, 4, 8}, {1024, 1, 3}};
  std::vector<double> truth;
  double total = 0.0;
  for (const Run& run : runs) {
    SCOPED_TRACE(testing::Message() << "candidates " << run.candidates << ", samples " << run.samples);
    PassTest t("restir_di.Initial");
    show(t, view, scene);
    t.param("candidates", std::to_string(run.candidates)).param("samples", std::to_string(run.samples));
    t.param("tiles", "on").param("picks", picks).param("visibility", "false").seed(29);
    const oracle::World world(t.prepared());
    if (truth.empty()) {
      for (size_t i = 0; i < view.pixels(); ++i) truth.push_back(world.directLight(view[i], false));
      for (double value : truth) total += value;
    }
    Sample sample;
    for (int frame = 0; frame < run.frames; ++frame) {
      t.run();
      const std::vector<Reservoir> out = t.output<Reservoir>("reservoirs");
      double mean = 0.0;
      for (size_t i = 0; i < out.size(); ++i) {
        ASSERT_TRUE(isFinite(out[i]));
        ASSERT_LT(lightOf(out[i]), world.lights().size());
        mean += estimate(world, view[i / run.samples], out[i], false) / run.samples;
      }
      sample.add(mean / total);
    }
    EXPECT_TRUE(agrees(sample, 1.0, 1e-4, 5));
    EXPECT_LT(sample.standardError(), resolved) << "too few samples to find anything";
  }
}

TEST(RestirTiles, PointsAreUnbiased) {
  for (const char* picks : {"power", "place"}) expectUnbiased(colouredPoints(), picks, 0.02);
}
TEST(RestirTiles, LightsOfEveryKindAreUnbiased) {
  for (const char* picks : {"power", "place"}) expectUnbiased(smallScene({}), picks, 0.02);
}

// With one candidate W is 1 / p of the light that came out: exactly, whatever its colour was rounded to.
TEST(RestirTiles, OneCandidateWeighsOneOverItsProbability) {
  const View view = planeView(64, 64, frontCamera());
  PassTest t("restir_di.Initial");
  show(t, view, colouredPoints());
  t.param("candidates", "1").param("tiles", "on").param("uniformShare", "0.3").param("visibility", "false").run();
  const std::vector<scene::GpuLight>& lights = t.prepared().lights;
  std::vector<int> seen(lights.size(), 0);
  for (const Reservoir& r : t.output<Reservoir>("reservoirs")) {
    if (!(r.weight > 0.0f)) continue;
    const double p = 0.7 * lights[lightOf(r)].pdf + 0.3 / static_cast<double>(lights.size());
    ASSERT_NEAR(r.weight * p, 1.0, 1e-5) << lightOf(r);
    ++seen[lightOf(r)];
  }
  for (const int count : seen) EXPECT_GT(count, 0);
}

std::vector<Reservoir> oneFrame(const char* tiles, uint32_t frame, uint32_t seed) {
  PassTest t("restir_di.Initial");
  show(t, planeView(kSide, kSide, frontCamera()), smallScene({}));
  t.param("tiles", tiles).param("candidates", "4").param("visibility", "false").frame(frame).seed(seed).run();
  return t.output<Reservoir>("reservoirs");
}

size_t alike(const std::vector<Reservoir>& a, const std::vector<Reservoir>& b) {
  size_t count = 0;
  for (size_t i = 0; i < a.size(); ++i) count += std::memcmp(&a[i], &b[i], sizeof a[i]) == 0 ? 1 : 0;
  return count;
}

// The same frame and seed are the same to the bit; another frame or seed has other tiles. Where nothing is said, tiles
// are on.
TEST(RestirTiles, FollowFrameAndSeed) {
  const std::vector<Reservoir> first = oneFrame("on", 3, 5);
  EXPECT_EQ(alike(first, oneFrame("on", 3, 5)), first.size());
  EXPECT_LT(alike(first, oneFrame("on", 4, 5)), first.size() / 2);
  EXPECT_LT(alike(first, oneFrame("on", 3, 6)), first.size() / 2);
  EXPECT_EQ(alike(oneFrame("auto", 3, 5), oneFrame("on", 3, 5)), first.size());
  EXPECT_LT(alike(first, oneFrame("off", 3, 5)), first.size() / 2);
}

TEST(RestirTiles, NoLightsLeaveEmptyReservoirs) {
  PassTest t("restir_di.Initial");
  show(t, planeView(9, 5, frontCamera()), smallScene({.points = false, .spot = false, .quad = false}));
  t.param("tiles", "on").param("visibility", "false").run();
  for (const Reservoir& r : t.output<Reservoir>("reservoirs")) {
    EXPECT_EQ(r.weight, 0.0f);
    EXPECT_EQ(r.confidence, 0.0f);
  }
}

/// A floor, a wall and a post under lights of every colour, from points, or from a mixture with spots and a lamp.
scene::Scene manyLights(bool mixture) {
  Builder b;
  scene::Material grey, lamp;
  grey.baseColor = {0.7f, 0.6f, 0.5f, 1.0f};
  grey.metallic = 0.0f;
  lamp.emission = {5.0f, 4.0f, 3.0f};
  const int greyOne = b.material(grey);
  b.add(quad({-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}, greyOne));
  b.add(quad({-2, 0, -2}, {2, 0, -2}, {2, 3, -2}, {-2, 3, -2}, greyOne));
  b.add(quad({-0.3f, 0, 0.2f}, {0.3f, 0, 0}, {0.3f, 1.3f, 0}, {-0.3f, 1.3f, 0.2f}, greyOne));
  if (mixture)
    b.add(quad({-1.2f, 2.6f, -0.6f}, {-0.4f, 2.6f, -0.6f}, {-0.4f, 2.6f, 0.2f}, {-1.2f, 2.6f, 0.2f}, b.material(lamp)));
  for (int i = 0; i < 60; ++i) {
    scene::PunctualLight light;
    light.position = {-1.8f + 0.4f * static_cast<float>(i % 10), 2.6f - 0.3f * static_cast<float>(i % 3),
                      1.5f - 0.5f * static_cast<float>(i / 10)};
    light.intensity = glm::vec3(i % 3 == 0 ? 0.5f : 0.02f, i % 3 == 1 ? 0.5f : 0.02f, i % 3 == 2 ? 0.5f : 0.02f);
    if (i % 20 == 7) light.intensity *= 8.0f;
    if (mixture && i % 4 == 1) {
      light.kind = scene::LightKind::Spot;
      light.direction = {0, -1, 0};
      light.outerCone = 0.9f;
    }
    if (mixture && i % 4 == 2) light.range = 2.5f;
    b.scene.lights.push_back(light);
  }
  b.scene.cameras.push_back(lookAt({0.3f, 1.6f, 4.0f}, {0, 0.7f, -0.6f}, 38.0f));
  return b.scene;
}

glm::vec3 skyTexel(uint32_t x, uint32_t y) {
  return x == 2 && y == 1 ? glm::vec3(1.5f, 1.2f, 1.0f) : glm::vec3(0.02f, 0.03f, 0.05f);
}

// Whole graphs with reuse in space and time, where pixels that merge have drawn from the same tiles. Chance of a false
// alarm: 1e-3 for all tiles of the picture, and as much for all means.
void expectUnbiasedReuse(const std::string& picks, const std::vector<std::string>& kinds) {
  for (const std::string& kind : kinds) {
    SCOPED_TRACE(kind);
    const bool mixture = kind != "points";
    scene::Scene scene = manyLights(mixture);
    if (kind == "sky") scene.environment = environmentOf(8, 4, skyTexel);
    Laboratory laboratory(std::move(scene), 32, 8);
    laboratory.measureTruth("1", 16, 3);
    const std::string mis = mixture ? "pairwise" : "z";
    Protocol p;
    p.set = {"gbuffer.jitter=true",      "initial.candidates=4", "initial.tiles=on",    "initial.picks=" + picks,
             "temporal.confidenceCap=4", "spatial.radius=8",     "spatial.neighbours=3"};
    for (const std::string pass : {"temporal", "spatial"})
      for (const char* setting : {"depthThreshold=10", "normalThreshold=180", "visibilityRays=true"})
        p.set.push_back(pass + "." + setting);
    p.set.push_back("temporal.mis=" + mis);
    p.set.push_back("spatial.mis=" + mis);
    p.restarts = 24;
    p.frames = 3;
    const image::TileTest t = laboratory.test(p, 1e-3 / static_cast<double>(kinds.size()));
    std::printf("%-7s %-8s |t| %.2f of %.2f, bias %+.2f %% (%+.2f ... %+.2f)\n", kind.c_str(), mis.c_str(), t.worstT,
                t.bound, 100 * t.relativeBias, 100 * t.intervalLow, 100 * t.intervalHigh);
    expectAgreement(t, 0.08);
  }
}
TEST(RestirTiles, ReuseStaysUnbiased) {
  expectUnbiasedReuse("power", {"points", "mixture"});
}
TEST(RestirTiles, ReuseOfPicksByPlaceStaysUnbiased) {
  expectUnbiasedReuse("place", {"points", "mixture", "sky"});
}

}  // namespace
}  // namespace weir::test
