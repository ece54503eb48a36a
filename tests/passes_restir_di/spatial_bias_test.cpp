// restir_di.Spatial: the mean of f · W against the sum over all lights, where neighbours differ most.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "setup.h"

namespace weir::test {
namespace {

using passes::Reservoir;

constexpr uint32_t kSide = 32;

struct Experiment {
  oracle::Mis mis = oracle::Mis::Pairwise;
  bool visibility = false;  ///< shadowed truth and, if `tested`, samples; rays in the merge if `rays`
  bool rays = false;
  bool tested = true;
  bool step = true;  ///< a step in depth and normal in the middle, else a plane with shadows' edges
  int iterations = 1, neighbours = 4, perPixel = 1;
  const char* radius = "6";
  int restarts = 48;
};

/// Means of the picture, of its middle (around the step) and of its rest, relative to the truth; one value of each a
/// restart, since pixels share neighbours.
struct Outcome {
  Sample whole, middle, rest;
};

Outcome run(const Experiment& e) {
  const View view = e.step ? stepView(kSide, kSide, frontCamera()) : planeView(kSide, kSide, frontCamera());
  PassTest t("restir_di.Spatial");
  show(t, view, smallScene({.veil = e.visibility}));
  t.count("reservoirs", e.perPixel)
      .param("mis", oracle::nameOf(e.mis))
      .param("visibilityRays", e.rays ? "true" : "false");
  t.param("iterations", std::to_string(e.iterations))
      .param("neighbours", std::to_string(e.neighbours))
      .param("radius", e.radius);
  t.param("depthThreshold", "10").param("normalThreshold", "180").seed(31);
  const oracle::World world(t.prepared());
  const std::vector<double> truth = directLight(world, view, e.visibility);
  const auto inMiddle = [](size_t i) { return i % kSide >= kSide / 2 - 4 && i % kSide < kSide / 2 + 4; };
  double truthMiddle = 0.0, truthRest = 0.0;
  for (size_t i = 0; i < truth.size(); ++i) (inMiddle(i) ? truthMiddle : truthRest) += truth[i];
  oracle::Random random(4);
  Outcome outcome;
  for (int restart = 0; restart < e.restarts; ++restart) {
    t.input("reservoirs", freshReservoirs(world, view, random, 4, e.visibility && e.tested, 1.0, e.perPixel)).run();
    const std::vector<Reservoir> out = t.output<Reservoir>("reservoirs");
    double middle = 0.0, rest = 0.0;
    for (size_t i = 0; i < out.size(); ++i) {
      EXPECT_TRUE(isFinite(out[i]));
      const size_t pixel = i / e.perPixel;
      const double value = estimate(world, view[pixel], out[i], e.visibility) / e.perPixel;
      (inMiddle(pixel) ? middle : rest) += value;
    }
    outcome.whole.add((middle + rest) / (truthMiddle + truthRest));
    outcome.middle.add(middle / truthMiddle);
    outcome.rest.add(rest / truthRest);
  }
  return outcome;
}

/// Chance of a false alarm: alpha for all three figures together.
void expectUnbiased(const Experiment& e, double alpha) {
  const Outcome o = run(e);
  EXPECT_TRUE(agrees(o.whole, 1.0, alpha, 3));
  EXPECT_TRUE(agrees(o.middle, 1.0, alpha, 3));
  EXPECT_TRUE(agrees(o.rest, 1.0, alpha, 3));
  EXPECT_LT(o.whole.standardError(), 0.01) << "too few samples to find anything";
}

// Chance of a false alarm of each test: 1e-4.
TEST(RestirSpatialBias, PairwiseIsUnbiasedAcrossAStep) {
  const Experiment settings[] = {{.neighbours = 1},
                                 {.neighbours = 16, .radius = "20"},
                                 {.iterations = 2, .perPixel = 3},
                                 {.iterations = 4, .neighbours = 3}};
  for (const Experiment& e : settings) {
    SCOPED_TRACE(testing::Message() << e.iterations << " iterations, " << e.neighbours << " neighbours");
    expectUnbiased(e, 1e-4 / 4);
  }
}
TEST(RestirSpatialBias, ZAndBalanceAreUnbiasedAcrossAStep) {
  for (const oracle::Mis mis : {oracle::Mis::Z, oracle::Mis::Balance}) {
    SCOPED_TRACE(oracle::nameOf(mis));
    expectUnbiased({.mis = mis, .neighbours = 5, .radius = "20"}, 1e-4 / 4);
    expectUnbiased({.mis = mis, .iterations = 2, .neighbours = 3, .perPixel = 2}, 1e-4 / 4);
  }
}
TEST(RestirSpatialBias, UnbiasedWithRaysAcrossShadows) {
  for (const oracle::Mis mis : oracle::kUnbiasedMis) {
    SCOPED_TRACE(oracle::nameOf(mis));
    expectUnbiased({.mis = mis, .visibility = true, .rays = true, .step = false, .radius = "10", .restarts = 32},
                   1e-4 / 6);
    // Untested samples: some are hidden where they come from. Two iterations: the first one's retest counts.
    expectUnbiased({.mis = mis,
                    .visibility = true,
                    .rays = true,
                    .tested = false,
                    .iterations = 2,
                    .neighbours = 3,
                    .perPixel = 2,
                    .restarts = 32},
                   1e-4 / 6);
  }
}
// No rays and untested samples: all that is left for the end is the shadow ray.
TEST(RestirSpatialBias, UnbiasedWithLateVisibility) {
  for (const oracle::Mis mis : oracle::kUnbiasedMis) {
    SCOPED_TRACE(oracle::nameOf(mis));
    expectUnbiased({.mis = mis, .visibility = true, .tested = false, .step = false, .iterations = 2, .radius = "10"},
                   1e-4 / 3);
  }
}
TEST(RestirSpatialBias, BiasedIsRightWhereSurfacesAreAlike) {
  // A plane without shadows, but not quite alike: horizons and cones are the same everywhere, so that no target
  // vanishes but the spot's, whose share is small.
  const Outcome o = run({.mis = oracle::Mis::Biased, .step = false, .radius = "2", .restarts = 24});
  EXPECT_NEAR(o.whole.mean(), 1.0, 0.01);
}
// The power of the above: what is known to be biased is found to be so. Chance to miss it: next to nothing.
TEST(RestirSpatialBias, BiasedIsBiasedAcrossAStep) {
  const Outcome o = run({.mis = oracle::Mis::Biased, .neighbours = 16, .radius = "20"});
  EXPECT_LT(o.whole.mean(), 0.97);
  EXPECT_LT(o.whole.t(1.0), -8.0);
}
TEST(RestirSpatialBias, TestedSamplesWithoutRaysAreBiased) {
  for (const oracle::Mis mis : oracle::kUnbiasedMis) {
    const Outcome o =
        run({.mis = mis, .visibility = true, .rays = false, .step = false, .radius = "10", .restarts = 16});
    EXPECT_LT(o.whole.t(1.0), -10.0) << oracle::nameOf(mis);
  }
}

}  // namespace
}  // namespace weir::test
