// restir_di.Initial: resampled importance sampling over lights picked by power.
#include <gtest/gtest.h>

#include <cmath>

#include "setup.h"

namespace weir::test {
namespace {

using passes::Reservoir;

constexpr uint32_t kSide = 32;

// The mean of f · W over pixels and frames is the sum over all lights. Pixels draw their own random numbers, so that
// each is an independent sample. Chance of a false alarm: 1e-4 for the whole test .
void expectUnbiased(bool visibility) {
  const View view = planeView(kSide, kSide, frontCamera());
  struct Run {
    int candidates, samples, frames;
    const char* triangles;
  };
  // Shadow rays are what makes a kernel slow to compile: fewer kernels with them.
  const std::vector<Run> runs =
      visibility ? std::vector<Run>{{1, 1, 24, "area"}, {8, 4, 8, "solidAngle"}, {1024, 1, 1, "solidAngle"}}
                 : std::vector<Run>{{1, 1, 48, "solidAngle"}, {1, 1, 48, "area"}, {2, 3, 24, "area"},
                                    {8, 2, 16, "solidAngle"}, {32, 4, 8, "area"}, {1024, 1, 1, "solidAngle"}};
  std::vector<double> truth;
  double total = 0.0;
  for (const Run& run : runs) {
    SCOPED_TRACE(testing::Message() << "candidates " << run.candidates << ", samples " << run.samples << ", by "
                                    << run.triangles);
    PassTest t("restir_di.Initial");
    show(t, view, smallScene({}));
    t.param("candidates", std::to_string(run.candidates)).param("samples", std::to_string(run.samples));
    t.param("visibility", visibility ? "true" : "false").param("triangles", run.triangles).seed(17);
    const oracle::World world(t.prepared());
    ASSERT_EQ(world.lights().size(), 8u);
    if (truth.empty()) {
      for (size_t i = 0; i < view.pixels(); ++i) truth.push_back(world.directLight(view[i], visibility));
      for (double value : truth) total += value / static_cast<double>(truth.size());
    }
    Sample sample;
    uint64_t wrongSeen = 0, tested = 0;
    for (int frame = 0; frame < run.frames; ++frame) {
      t.run();
      const std::vector<Reservoir> out = t.output<Reservoir>("reservoirs");
      ASSERT_EQ(out.size(), view.pixels() * run.samples);
      for (size_t i = 0; i < view.pixels(); ++i) {
        double mean = 0.0;
        for (int k = 0; k < run.samples; ++k) {
          const Reservoir& r = out[i * run.samples + k];
          ASSERT_TRUE(isFinite(r));
          ASSERT_EQ(r.confidence, 1.0f);
          mean += estimate(world, view[i], r, false) / run.samples;
          if (!(r.weight > 0.0f)) continue;
          ++tested;
          wrongSeen += isSeen(r) != (visibility && world.sees(view[i], lightOf(r), r.place)) ? 1 : 0;
        }
        sample.add((mean - truth[i]) / total);
      }
    }
    EXPECT_TRUE(agrees(sample, 0.0, 1e-4, static_cast<int>(runs.size())));
    EXPECT_LT(sample.standardError(), 0.02) << "too few samples to find anything";
    // Hidden samples are gone and the others are marked; shadows' edges may fall either way in single precision.
    EXPECT_LE(wrongSeen, tested / 2000);
  }
}

TEST(RestirInitial, MeanIsTheSumOverAllLights) {
  expectUnbiased(false);
}
TEST(RestirInitial, MeanWithShadowRaysIsTheShadowedSum) {
  expectUnbiased(true);
}

// A few centimetres under an emitter, in the middle and across its edge, where points by area would be fireflies. The
// truth is a quadrature fine enough for a part in 10⁴. Chance of a false alarm: 1e-4 over the three places.
TEST(RestirInitial, NearTrianglesBySolidAngle) {
  for (const auto& [x, y, below] : {std::tuple{-0.9f, 1.05f, 0.05}, {-1.5f, 1.0f, 0.02}, {-0.2f, 1.4f, 0.1}}) {
    SCOPED_TRACE(testing::Message() << x << ", " << y);
    scene::Camera camera = frontCamera(5e-4);
    camera.eye.x = x;
    camera.eye.y = y;
    View view(64, 64, camera);
    const double emitter = 2.0 + 0.25 * (x + 1.5);
    for (uint32_t i = 0; i < 64 * 64; ++i) view.setOnPlane(i % 64, i / 64, emitter - below, {0.2, 0.1, 1.0});
    PassTest t("restir_di.Initial");
    show(t, view, smallScene({.points = false, .spot = false, .blocker = false}));
    t.param("candidates", "1").param("visibility", "false").seed(19);
    const oracle::World world(t.prepared());
    const double truth = world.directLight(view[64 * 32 + 32], false, 2000);
    Sample sample;
    for (int frame = 0; frame < 4; ++frame) {
      t.run();
      const std::vector<Reservoir> out = t.output<Reservoir>("reservoirs");
      for (size_t i = 0; i < out.size(); ++i) sample.add(estimate(world, view[i], out[i], false) / truth);
    }
    EXPECT_TRUE(agrees(sample, 1.0, 1e-4, 3));
    EXPECT_LT(sample.standardError(), 0.02) << "fireflies";
  }
}

// A glossy surface that reflects the emitter's middle into the eye: α = 0.01, so that the lobe covers a hundredth of
// the emitter and its peak is a thousand times the diffuse part. Any share of the candidates along the lobe is
// unbiased, and some is better than none. Chance of a false alarm: 1e-4 over the three shares.
TEST(RestirInitial, GlossySurfacesAlongTheLobe) {
  scene::Camera camera = frontCamera(5e-4);
  View view(64, 64, camera);
  const oracle::Vec toEmitter = glm::normalize(oracle::Vec(-1.0, 1.1, 2.1)), toEye(0, 0, 1);
  const Finish finish{{0.3, 0.3, 0.3}, {0.5, 0.6, 0.7}, 0.1};
  for (uint32_t i = 0; i < 64 * 64; ++i) {
    view.setOnPlane(i % 64, i / 64, 0.0, glm::normalize(toEmitter + toEye), finish);
  }
  double truth = 0.0, errorWithout = 0.0;
  for (const char* share : {"0", "0.25", "0.8"}) {
    SCOPED_TRACE(share);
    PassTest t("restir_di.Initial");
    show(t, view, smallScene({.points = false, .spot = false, .blocker = false}));
    t.param("candidates", "4").param("visibility", "false").param("lobeShare", share).seed(23);
    const oracle::World world(t.prepared());
    if (truth == 0.0) truth = world.directLight(view[64 * 32 + 32], false, 3000);
    Sample sample;
    for (int frame = 0; frame < 8; ++frame) {
      t.run();
      const std::vector<Reservoir> out = t.output<Reservoir>("reservoirs");
      for (size_t i = 0; i < out.size(); ++i) sample.add(estimate(world, view[i], out[i], false) / truth);
    }
    EXPECT_TRUE(agrees(sample, 1.0, 1e-4, 3));
    if (errorWithout == 0.0) {
      errorWithout = sample.standardError();
    } else {
      EXPECT_LT(sample.standardError(), 0.5 * errorWithout);
    }
  }
}

// Positions that differ by 1e-4 of the distance: every pixel has the same targets.
View onePointView(uint32_t width, uint32_t height) {
  return planeView(width, height, frontCamera(5e-4));
}

scene::Scene fourPoints() {
  return pointScene(
      {{{0, 0, 1}, {1, 1, 1}}, {{1, 0, 1}, {5, 1, 1}}, {{-1, 1, 2}, {2, 9, 2}}, {{2, 2, 0.5f}, {1, 1, 8}}});
}

/// Probability of each light in one of two halves of the table's cells, a share of the picks uniform.
std::vector<double> pickedInHalf(const std::vector<scene::AliasCell>& table, size_t half, double share) {
  std::vector<double> p(table.size(), 0.0);
  const size_t cells = table.size() / 2;
  for (size_t c = half * cells; c < (half + 1) * cells; ++c) {
    const double kept = share + (1.0 - share) * table[c].threshold;
    p[c] += kept / static_cast<double>(cells);
    p[table[c].alias] += (1.0 - kept) / static_cast<double>(cells);
  }
  return p;
}

// With M candidates of probability p (a share of them uniform, the others by power), the chosen light's distribution is
// known exactly for M = 1 (p itself) and M = 2 (one from each half of the table), and is p̂ / Σ p̂ to within 1/M for
// many. Chance of a false alarm: 1e-4 for each of the five.
TEST(RestirInitial, ChosenLightsFollowResampling) {
  const View view = onePointView(64, 64);
  for (const auto& [candidates, share] : {std::pair{1, 0.1}, {1, 0.0}, {1, 1.0}, {2, 0.25}, {1024, 0.1}}) {
    SCOPED_TRACE(testing::Message() << candidates << " candidates, uniform share " << share);
    PassTest t("restir_di.Initial");
    show(t, view, fourPoints());
    t.param("candidates", std::to_string(candidates)).param("visibility", "false").seed(3);
    // Each pixel by itself: those of a tile choose from the same picks, and counting them wants independent ones.
    t.param("uniformShare", std::to_string(share)).param("tiles", "off");
    const oracle::World world(t.prepared());
    const size_t n = world.lights().size();
    ASSERT_EQ(n, 4u);
    std::vector<double> target(n), source(n), expected(n, 0.0);
    double targets = 0.0, power = 0.0;
    for (size_t i = 0; i < n; ++i) {
      target[i] = world.target(view[0], static_cast<uint32_t>(i), 0);
      targets += target[i];
      source[i] = oracle::luminance(oracle::Vec(world.lights()[i].radiance));
      power += source[i];
    }
    for (double& p : source) p = (1.0 - share) * p / power + share / static_cast<double>(n);
    for (size_t i = 0; i < n; ++i) {
      if (candidates == 1) expected[i] = source[i];
      if (candidates == 1024) expected[i] = target[i] / targets;
    }
    if (candidates == 2) {
      const std::vector<double> first = pickedInHalf(t.prepared().aliasTable, 0, share),
                                second = pickedInHalf(t.prepared().aliasTable, 1, share);
      for (size_t i = 0; i < n; ++i) {
        for (size_t j = 0; j < n; ++j) {
          const double wi = target[i] / source[i], wj = target[j] / source[j];
          expected[i] += first[i] * second[j] * wi / (wi + wj);
          expected[j] += first[i] * second[j] * wj / (wi + wj);
        }
      }
    }
    std::vector<uint64_t> counts(n, 0);
    for (int frame = 0; frame < 4; ++frame) {
      t.run();
      for (const Reservoir& r : t.output<Reservoir>("reservoirs")) {
        ASSERT_LT(lightOf(r), n);
        ++counts[lightOf(r)];
        if (candidates == 1) {
          ASSERT_NEAR(r.weight * source[lightOf(r)], 1.0, 1e-5);
        }
      }
    }
    EXPECT_GT(chiSquareP(counts, expected), 1e-4);
  }
}

TEST(RestirInitial, NoLightsLeaveEmptyReservoirs) {
  const View view = planeView(9, 5, frontCamera());
  for (const char* visibility : {"true", "false"}) {
    PassTest t("restir_di.Initial");
    show(t, view, smallScene({.points = false, .spot = false, .quad = false}));
    t.param("visibility", visibility).run();
    for (const Reservoir& r : t.output<Reservoir>("reservoirs")) {
      EXPECT_EQ(r.weight, 0.0f);
      EXPECT_EQ(r.confidence, 0.0f);
    }
  }
}

TEST(RestirInitial, NoSurfaceLeavesEmptyReservoirs) {
  View view = planeView(16, 16, frontCamera());
  for (uint32_t y = 0; y < 16; ++y)
    for (uint32_t x = y % 2; x < 16; x += 2) view.set(x, y, nothing());
  PassTest t("restir_di.Initial");
  show(t, view, smallScene({.blocker = false}));
  t.param("samples", "4").param("visibility", "false").run();
  const std::vector<Reservoir> out = t.output<Reservoir>("reservoirs");
  for (size_t i = 0; i < out.size(); ++i) {
    EXPECT_EQ(out[i].confidence, view.has(i / 4) ? 1.0f : 0.0f);
    EXPECT_EQ(out[i].weight > 0.0f, view.has(i / 4));
  }
}

// Sizes that are no multiple of a work group's, down to one pixel: every pixel is written, and what it gets depends on
// the pixel and not on the picture's size.
TEST(RestirInitial, AnySizeWritesEveryPixel) {
  for (const auto& [width, height] : {std::pair{1u, 1u}, {13u, 7u}, {8u, 9u}, {1u, 33u}}) {
    const View view = onePointView(width, height);
    PassTest t("restir_di.Initial");
    show(t, view, fourPoints());
    t.param("samples", "2").param("visibility", "false").run();
    const std::vector<Reservoir> out = t.output<Reservoir>("reservoirs");
    ASSERT_EQ(out.size(), size_t{width} * height * 2);
    for (const Reservoir& r : out) {
      EXPECT_GT(r.weight, 0.0f);
      EXPECT_EQ(r.confidence, 1.0f);
    }
  }
}

// A light under the horizon of the shading or of the geometric normal is never chosen, although it has most of the
// power.
TEST(RestirInitial, LightsUnderTheHorizonAreNotChosen) {
  View view(16, 16, frontCamera(5e-4));
  for (uint32_t y = 0; y < 16; ++y)
    for (uint32_t x = 0; x < 16; ++x)
      view.set(x, y,
               packSurface(5.0, x < 8 ? oracle::Vec(0, 0, 1) : oracle::Vec(0.9, 0, 0.5),
                           x < 8 ? oracle::Vec(0.9, 0, 0.5) : oracle::Vec(0, 0, 1), {}));
  PassTest t("restir_di.Initial");
  show(t, view, pointScene({{{-4, 0, 1}, {100, 100, 100}}, {{4, 0, 2}, {1, 1, 1}}}));
  t.param("candidates", "64").param("visibility", "false").run();
  int chosen = 0;
  for (const Reservoir& r : t.output<Reservoir>("reservoirs")) {
    if (!(r.weight > 0.0f)) continue;
    EXPECT_EQ(lightOf(r), 1u);
    ++chosen;
  }
  EXPECT_GT(chosen, 50);
}

}  // namespace
}  // namespace weir::test
