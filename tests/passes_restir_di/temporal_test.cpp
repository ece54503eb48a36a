// restir_di.Temporal: which pixel's history is taken, and what a merge of two reservoirs gives.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "setup.h"

namespace weir::test {
namespace {

using oracle::Vec;
using passes::PackedSurface;
using passes::Reservoir;

constexpr uint32_t kSide = 32;

void openThresholds(PassTest& t) {
  t.param("depthThreshold", "10").param("normalThreshold", "180").param("albedoThreshold", "1");
}

std::vector<float> constantMotion(size_t pixels, float x, float y) {
  std::vector<float> motion;
  for (size_t i = 0; i < pixels; ++i) motion.insert(motion.end(), {x, y});
  return motion;
}

/// Own reservoirs without a sample, and a history whose light is the number of its pixel: whoever comes out says where
/// it was.
struct Named {
  std::vector<Reservoir> own, history;
  explicit Named(uint32_t pixels) {
    for (uint32_t i = 0; i < pixels; ++i) {
      own.push_back({0, 0, 0.0f, 1.0f});
      history.push_back({i, 0, 1.0f, 3.0f});
    }
  }
};

TEST(RestirTemporal, MotionPicksThePreviousPixel) {
  const scene::Camera camera = frontCamera(5e-4);
  View view(kSide, kSide, camera);
  oracle::Random random(7);
  std::vector<uint32_t> jitterX, jitterY;
  for (uint32_t i = 0; i < kSide * kSide; ++i) {
    jitterX.push_back(static_cast<uint32_t>(random() % 255));
    jitterY.push_back(static_cast<uint32_t>(random() % 255));
    view.set(i % kSide, i / kSide, packSurface(5.0, {0, 0, 1}, {0, 0, 1}, {}, jitterX[i], jitterY[i]));
  }
  const Named named(kSide * kSide);
  PassTest t("restir_di.Temporal");
  show(t, view, namedLights(kSide * kSide));
  t.input("previousSurface", view.packed()).input("reservoirs", named.own).input("history", named.history);
  const float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  const std::pair<float, float> motions[] = {
      {0, 0},        {3, -2},        {-1, 1},  {2.3f, -1.4f}, {-0.37f, 0.61f}, {40, 0},           {0, -32},
      {infinity, 0}, {0, -infinity}, {nan, 0}, {0, nan},      {1e30f, 1e30f},  {4294967296.0f, 0}};
  for (const auto& [x, y] : motions) {
    SCOPED_TRACE(testing::Message() << "motion " << x << ", " << y);
    t.input("motion", constantMotion(view.pixels(), x, y)).run();
    const std::vector<Reservoir> out = t.output<Reservoir>("reservoirs");
    for (uint32_t i = 0; i < out.size(); ++i) {
      const double px = i % kSide + (jitterX[i] + 0.5) / 255.0 + x, py = i / kSide + (jitterY[i] + 0.5) / 255.0 + y;
      const double tooClose = 1e-5;  // to a pixel's edge for single precision to decide
      if (std::abs(px - std::round(px)) < tooClose || std::abs(py - std::round(py)) < tooClose) continue;
      const bool inside = px >= 0.0 && py >= 0.0 && px < kSide && py < kSide;
      ASSERT_EQ(out[i].confidence, inside ? 4.0f : 1.0f);
      ASSERT_EQ(out[i].weight > 0.0f, inside);
      if (inside) {
        ASSERT_EQ(lightOf(out[i]), static_cast<uint32_t>(py) * kSide + static_cast<uint32_t>(px));
      }
    }
  }
}

// Each threshold alone, the others open: a surface just inside it takes part, one just outside doesn't, one that isn't
// there never.
TEST(RestirTemporal, UnlikeSurfacesAreRejected) {
  const View view = planeView(kSide, kSide, frontCamera(5e-4));
  const auto tilted = [](double degrees) {
    return Vec(std::sin(glm::radians(degrees)), 0.0, std::cos(glm::radians(degrees)));
  };
  Finish paler, palest;
  paler.diffuse.y += 0.18;
  palest.diffuse.y += 0.22;
  const Vec up(0, 0, 1);
  struct Case {
    PackedSurface before;
    const char* rejectedBy;
  };
  const Case cases[] = {{packSurface(5.0, up, up, {}), ""},
                        {packSurface(5.45, up, up, {}), ""},
                        {packSurface(5.55, up, up, {}), "depth"},
                        {packSurface(4.45, up, up, {}), "depth"},
                        {packSurface(5.0, up, tilted(24.5), {}), ""},
                        {packSurface(5.0, up, tilted(25.5), {}), "normal"},
                        {packSurface(5.0, up, tilted(-60.0), {}), "normal"},
                        {packSurface(5.0, up, up, paler), ""},
                        {packSurface(5.0, up, up, palest), "albedo"},
                        {nothing(), "all"}};
  std::vector<PackedSurface> before;
  for (size_t i = 0; i < view.pixels(); ++i) before.push_back(cases[i % std::size(cases)].before);
  const Named named(kSide * kSide);
  for (const std::string only : {"depth", "normal", "albedo"}) {
    PassTest t("restir_di.Temporal");
    show(t, view, namedLights(kSide * kSide));
    t.input("previousSurface", before).input("reservoirs", named.own).input("history", named.history);
    t.param("depthThreshold", only == "depth" ? "0.1" : "10").param("normalThreshold", only == "normal" ? "25" : "180");
    t.param("albedoThreshold", only == "albedo" ? "0.2" : "1").run();
    const std::vector<Reservoir> out = t.output<Reservoir>("reservoirs");
    for (size_t i = 0; i < out.size(); ++i) {
      const std::string by = cases[i % std::size(cases)].rejectedBy;
      ASSERT_EQ(out[i].confidence, by == only || by == "all" ? 1.0f : 4.0f)
          << only << ", case " << i % std::size(cases);
    }
  }
}

// Depth is compared at the distance from which last frame's camera should have seen the point, not at this frame's.
TEST(RestirTemporal, DepthFollowsTheCamera) {
  scene::Camera far = frontCamera(5e-4), near = far;
  near.eye.z = 3.0f;
  const View before = planeView(8, 8, far), view = planeView(8, 8, near);
  const Named named(64);
  PassTest t("restir_di.Temporal");
  show(t, before, namedLights(64));
  t.input("previousSurface", before.packed()).input("reservoirs", named.own).input("history", named.history).run();
  t.input("surface", view.packed()).camera(near).run();
  for (const Reservoir& r : t.output<Reservoir>("reservoirs")) EXPECT_EQ(r.confidence, 4.0f);
  // Now both cameras are the near one: a surface at the old distance is another one.
  t.run();
  for (const Reservoir& r : t.output<Reservoir>("reservoirs")) EXPECT_EQ(r.confidence, 1.0f);
}

// Two reservoirs by hand, with every combination of null samples and zero targets, seen by a camera that moved, on a
// glossy surface that was bent: W to 3e-4 of what theory gives in every mode, and how often each survives. Chance of a
// false alarm: 1e-4.
TEST(RestirTemporal, MergesTwoReservoirs) {
  scene::Camera camera = frontCamera(5e-4), previousCamera = camera;
  previousCamera.eye = {2.0f, 0.0f, 4.5f};
  previousCamera.forward = glm::normalize(-previousCamera.eye);
  previousCamera.up = glm::vec3(0, 1, 0);
  Finish glossy;
  glossy.f0 = {0.6, 0.5, 0.4};
  glossy.roughness = 0.35;
  View view(kSide, kSide, camera), before(kSide, kSide, previousCamera);
  for (uint32_t i = 0; i < kSide * kSide; ++i) {
    view.set(i % kSide, i / kSide, packSurface(5.0, {0, 0, 1}, {-0.3, 0, 1}, glossy));
    before.set(i % kSide, i / kSide, packSurface(4.9, {0, 0, 1}, {0.5, 0, 1}, glossy));
  }
  // Light 2 is under the horizon of `view`'s shading normal, light 3 under that of `before`'s; light 4 is a triangle's
  // first.
  scene::Scene scene = smallScene({.points = false, .spot = false, .blocker = false});
  scene.lights =
      pointScene(
          {{{1, 1, 2}, {3, 3, 3}}, {{-0.5f, -1, 1.5f}, {2, 3, 4}}, {{4, 0, 0.6f}, {9, 9, 9}}, {{-4, 0, 1}, {9, 9, 9}}})
          .lights;
  constexpr uint32_t kFirst = 2;  // triangles come first in the table
  struct Case {
    Reservoir own, history;
  };
  const std::vector<Case> cases = {
      {{kFirst + 0, 0, 0.7f, 1}, {kFirst + 1, 0, 1.9f, 6}}, {{kFirst + 1, 0, 3.0f, 1}, {kFirst + 0, 0, 0.2f, 20}},
      {{0, 77777, 2.0f, 1}, {1, 0x12345678, 5.0f, 3}},      {{kFirst + 0, 0, 0.7f, 1}, {0, 0, 0.0f, 6}},
      {{0, 0, 0.0f, 1}, {kFirst + 1, 0, 1.9f, 6}},          {{kFirst + 0, 0, 0.7f, 1}, {kFirst + 2, 0, 1.9f, 6}},
      {{kFirst + 3, 0, 0.7f, 1}, {kFirst + 1, 0, 1.9f, 6}}, {{0, 0, 0.0f, 1}, {0, 0, 0.0f, 6}}};
  std::vector<Reservoir> own, history;
  for (size_t i = 0; i < view.pixels(); ++i) {
    own.push_back(cases[i % cases.size()].own);
    history.push_back(cases[i % cases.size()].history);
  }
  for (const oracle::Mis mis : oracle::kEveryMis) {
    SCOPED_TRACE(oracle::nameOf(mis));
    PassTest t("restir_di.Temporal");
    show(t, view, scene);
    openThresholds(t);
    t.param("mis", oracle::nameOf(mis)).input("previousSurface", before.packed());
    t.input("reservoirs", own).input("history", history).seed(11);
    const oracle::World world(t.prepared());
    ASSERT_EQ(t.prepared().triangleLights, kFirst);
    std::vector<Sample> survived(cases.size());
    for (int frame = 0; frame < 16; ++frame) {
      t.camera(previousCamera).run();  // what this frame leaves doesn't matter: it moves the camera
      t.camera(camera).run();
      const std::vector<Reservoir> out = t.output<Reservoir>("reservoirs");
      for (size_t i = 0; i < out.size(); ++i) {
        const Reservoir &a = own[i], &b = history[i];
        const auto input = [&](const Reservoir& r) {
          return oracle::MergeInput{
              r.confidence,
              r.weight,
              {world.target(view[i], r.light, r.place), world.target(before[i], r.light, r.place)}};
        };
        const oracle::Merged merged = oracle::merge({input(a), input(b)}, mis);
        ASSERT_EQ(out[i].confidence, static_cast<float>(merged.confidence)) << "case " << i % cases.size();
        if (merged.sum == 0.0) {
          ASSERT_EQ(out[i].weight, 0.0f) << "case " << i % cases.size();
          continue;
        }
        const bool second = lightOf(out[i]) == b.light && out[i].place == b.place && b.weight > 0.0f;
        ASSERT_TRUE(second || (lightOf(out[i]) == a.light && out[i].place == a.place));
        ASSERT_NEAR(out[i].weight / merged.weight[second ? 1 : 0], 1.0, 3e-4) << "case " << i % cases.size();
        // Survivals in units of their standard deviation, if there is any chance in them.
        const double p = merged.probability[1];
        if (p > 1e-9 && p < 1.0 - 1e-9)
          survived[i % cases.size()].add(((second ? 1.0 : 0.0) - p) / std::sqrt(p * (1.0 - p)));
        else
          ASSERT_EQ(second, p > 0.5);
      }
    }
    int random = 0;
    for (const Sample& s : survived) random += s.count() > 0 ? 1 : 0;
    EXPECT_GE(random, 3);
    for (const Sample& s : survived) {
      if (s.count() == 0) continue;
      EXPECT_TRUE(agrees(s, 0.0, 0.5e-4, random));
    }
  }
}

}  // namespace
}  // namespace weir::test
