// restir_di.Temporal over many frames: the confidence cap, poisoned history, and the mean of f · W.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "setup.h"

namespace weir::test {
namespace {

using passes::Reservoir;

constexpr uint32_t kSide = 32;

std::vector<float> constantMotion(size_t pixels, float x, float y) {
  std::vector<float> motion;
  for (size_t i = 0; i < pixels; ++i) motion.insert(motion.end(), {x, y});
  return motion;
}

// Fed back for 200 frames, the confidence is that of the frames so far and never more than the cap and the fresh frame,
// whether the samples are there or null.
TEST(RestirHistory, ConfidenceIsCapped) {
  const View view = planeView(16, 16, frontCamera());
  for (const int cap : {1, 7, 1024}) {
    PassTest t("restir_di.Temporal");
    show(t, view, smallScene({}));
    t.param("confidenceCap", std::to_string(cap))
        .feedBack("history", "reservoirs")
        .input("previousSurface", view.packed());
    const oracle::World world(t.prepared());
    oracle::Random random(5);
    for (int frame = 0; frame < 200; ++frame) {
      // Fresh ones, some of them null, for the first frames and now and then: they make no difference to the
      // confidence.
      if (frame < 4 || frame % 50 == 0) t.input("reservoirs", freshReservoirs(world, view, random, 2, true));
      t.run();
      if (frame > 30 && frame % 10 != 9) continue;
      for (const Reservoir& r : t.output<Reservoir>("reservoirs")) {
        ASSERT_EQ(r.confidence, 1.0f + static_cast<float>(std::min(frame, cap))) << "frame " << frame;
        ASSERT_TRUE(isFinite(r));
      }
    }
    t.resetHistory();
    t.run();
    for (const Reservoir& r : t.output<Reservoir>("reservoirs")) ASSERT_EQ(r.confidence, 1.0f);
  }
}

// Whatever the history holds, what comes out is finite and names a light, the fresh sample survives, and one frame
// later all is as if nothing had been.
TEST(RestirHistory, PoisonDoesNotSpread) {
  const View view = planeView(kSide, kSide, frontCamera());
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  const Reservoir poison[] = {{0, 0, nan, 5},          {0, 0, infinity, 5},
                              {0, 0, -infinity, 5},    {0, 0, 1, nan},
                              {0, 0, 1, infinity},     {0, 0, 1, -3},
                              {0x7fffffff, 0, 1, 5},   {0xffffffff, 0, 1, 5},
                              {8, 0xffffffff, 1, 5},   {0x80000000, 7, nan, nan},
                              {3, 0, -1, 5},           {2, 0xdeadbeef, 3e38f, 5},
                              {0xdeadbeef, 0, nan, 2}, {0, 0, infinity, infinity},
                              {4, 1, 1, 3e38f}};
  for (const char* mis : {"biased", "z", "balance", "pairwise"}) {
    PassTest t("restir_di.Temporal");
    show(t, view, smallScene({}));
    t.param("mis", mis)
        .param("confidenceCap", "6")
        .feedBack("history", "reservoirs")
        .input("previousSurface", view.packed());
    const oracle::World world(t.prepared());
    ASSERT_EQ(world.lights().size(), 8u);
    oracle::Random random(6);
    const std::vector<Reservoir> fresh = freshReservoirs(world, view, random, 16, false);
    t.input("reservoirs", fresh).run(3);
    std::vector<Reservoir> bad = t.output<Reservoir>("reservoirs");
    for (size_t i = 0; i < bad.size(); ++i) bad[i] = poison[i % std::size(poison)];
    t.executor().writeResource("it.reservoirs", std::as_bytes(std::span(bad)));
    for (int frame = 0; frame < 3; ++frame) {
      t.run();
      const std::vector<Reservoir> out = t.output<Reservoir>("reservoirs");
      for (size_t i = 0; i < out.size(); ++i) {
        SCOPED_TRACE(testing::Message() << mis << ", frame " << frame << ", poison " << i % std::size(poison));
        ASSERT_TRUE(isFinite(out[i]));
        ASSERT_LT(lightOf(out[i]), 8u);
        ASSERT_GE(out[i].confidence, 1.0f);
        ASSERT_LE(out[i].confidence, 7.0f);
        // A huge but finite weight is a sample like any other; all else must leave the fresh one.
        ASSERT_TRUE(out[i].weight > 0.0f || fresh[i].weight == 0.0f);
      }
    }
  }
}

/// One frame on fresh reservoirs and a history made by the oracle where last frame's camera and surfaces were, or
/// several frames fed back. Pixels draw from reservoirs of their own, so that each is an independent sample.
struct Experiment {
  oracle::Mis mis;
  bool rays;          ///< shadowed truth, rays in the weights
  bool step;          ///< surfaces that differ between the reservoirs; else one plane for both
  int fedBack;        ///< 0: the history is given
  bool tested;        ///< hidden samples are null already, as Initial leaves them
  bool dark = false;  ///< shadowed truth although no rays are asked for: biased if the samples were tested
};

Sample run(const Experiment& e) {
  const bool shadowed = e.rays || e.dark;
  scene::Camera camera = frontCamera(), before = camera;
  if (e.step && e.fedBack == 0) before.eye = {0.6f, 0.3f, 5.2f};
  const View view = e.step ? stepView(kSide, kSide, camera) : planeView(kSide, kSide, camera);
  const View previous = e.step ? stepView(kSide, kSide, before) : view;
  PassTest t("restir_di.Temporal");
  show(t, view, smallScene({.veil = shadowed}));
  t.param("depthThreshold", "10").param("normalThreshold", "180").param("mis", oracle::nameOf(e.mis)).seed(23);
  t.param("visibilityRays", e.rays ? "true" : "false").param("confidenceCap", "4");
  if (e.fedBack > 0) t.feedBack("history", "reservoirs");
  // Along and across the step: many pixels find their history on the other side.
  t.input("motion", constantMotion(view.pixels(), 11.0f, 3.0f)).input("previousSurface", previous.packed());
  const oracle::World world(t.prepared());
  const std::vector<double> truth = directLight(world, view, shadowed);
  double total = 0.0;
  for (double value : truth) total += value / static_cast<double>(truth.size());
  oracle::Random random(99);
  Sample sample;
  uint64_t samples = 0, hidden = 0;
  for (int restart = 0; restart < 12; ++restart) {
    if (e.fedBack == 0) {
      t.input("history", freshReservoirs(world, previous, random, 4, e.tested, 3.0));
      t.camera(before).run();
      t.camera(camera).input("reservoirs", freshReservoirs(world, view, random, 4, e.tested)).run();
    } else {
      t.resetHistory();
      for (int frame = 0; frame < e.fedBack; ++frame)
        t.input("reservoirs", freshReservoirs(world, view, random, 4, e.tested)).run();
    }
    const std::vector<Reservoir> out = t.output<Reservoir>("reservoirs");
    for (size_t i = 0; i < out.size(); ++i) {
      EXPECT_TRUE(isFinite(out[i]));
      sample.add((estimate(world, view[i], out[i], shadowed) - truth[i]) / total);
      if (!(out[i].weight > 0.0f)) continue;
      ++samples;
      const double through = world.transmittance(view[i], lightOf(out[i]), out[i].place);
      hidden += through == 0.0 || (isSeen(out[i]) && through < 1.0) ? 1 : 0;
    }
  }
  // What survives was tested: where it is hidden, or not wholly seen though it says so, single precision saw an edge
  // elsewhere. Pixels without a history pass on what they got.
  if (e.rays && e.tested) {
    EXPECT_LE(hidden, samples / 1000);
  }
  return sample;
}

// Without rays and with samples that nobody tested, the partition holds wherever the targets are above zero, so that
// any visibility may be multiplied in later. Chance of a false alarm of each test: 1e-4.
TEST(RestirHistory, UnbiasedWithoutOcclusion) {
  for (const oracle::Mis mis : oracle::kUnbiasedMis) {
    SCOPED_TRACE(oracle::nameOf(mis));
    const Sample once = run({mis, false, true, 0, false}), fed = run({mis, false, true, 6, false});
    EXPECT_TRUE(agrees(once, 0.0, 1e-4, 6));
    EXPECT_TRUE(agrees(fed, 0.0, 1e-4, 6));
    EXPECT_LT(std::max(once.standardError(), fed.standardError()), 0.015) << "too few samples to find anything";
  }
}
// With rays it doesn't matter whether hidden samples come in: their own pixel's domain doesn't contain them.
TEST(RestirHistory, UnbiasedWithRaysUnderOcclusion) {
  for (const oracle::Mis mis : oracle::kUnbiasedMis) {
    SCOPED_TRACE(oracle::nameOf(mis));
    const Sample tested = run({mis, true, true, 0, true}), untested = run({mis, true, true, 0, false}),
                 fed = run({mis, true, true, 4, true});
    for (const Sample& s : {tested, untested, fed}) {
      EXPECT_TRUE(agrees(s, 0.0, 1e-4, 9));
      EXPECT_LT(s.standardError(), 0.015) << "too few samples to find anything";
    }
  }
}
TEST(RestirHistory, BiasedIsRightWhereSurfacesAreAlike) {
  EXPECT_TRUE(agrees(run({oracle::Mis::Biased, false, false, 0, false}), 0.0, 1e-4));
}
// The power of the above. The same picture, merged by confidence alone, is too dark; so is what merges tested samples
// without rays, whatever the weights. Chance to miss it: next to nothing.
TEST(RestirHistory, BiasedIsBiasedAcrossAStep) {
  const Sample sample = run({oracle::Mis::Biased, false, true, 0, false});
  EXPECT_LT(sample.mean(), -0.02);
  EXPECT_FALSE(agrees(sample, 0.0, 1e-4));
}
TEST(RestirHistory, TestedSamplesWithoutRaysAreBiased) {
  for (const oracle::Mis mis : oracle::kUnbiasedMis) {
    const Sample sample = run({mis, false, true, 0, true, true});
    EXPECT_LT(sample.mean(), 0.0);
    EXPECT_FALSE(agrees(sample, 0.0, 1e-4)) << oracle::nameOf(mis);
  }
}

}  // namespace
}  // namespace weir::test
