// restir_di.Spatial: who takes part, and what a merge of hand-made reservoirs gives.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "setup.h"

namespace weir::test {
namespace {

using oracle::Vec;
using passes::PackedSurface;
using passes::Reservoir;

constexpr uint32_t kSide = 32;

/// Null reservoirs in a picture without light but one: whatever comes out of it was picked as a neighbour. Every
/// reservoir names its pixel and sample as its light.
std::vector<Reservoir> named(uint32_t pixels, uint32_t perPixel) {
  std::vector<Reservoir> result;
  for (uint32_t i = 0; i < pixels * perPixel; ++i) result.push_back({i, 0, 1.0f, 1.0f});
  return result;
}

// Over the whole picture every reservoir's sample is as good as any: what comes out lies inside the radius, in the
// picture (not wrapped around its edges), on the same of the pixel's samples; and everything inside the radius does
// come out.
TEST(RestirSpatial, NeighboursLieInTheRadius) {
  const View view = planeView(kSide, kSide, frontCamera(5e-4));
  for (const auto& [radius, perPixel] : {std::pair{1.0, 1u}, {4.0, 3u}, {1024.0, 1u}, {9.5, 1u}}) {
    SCOPED_TRACE(testing::Message() << "radius " << radius);
    PassTest t("restir_di.Spatial");
    show(t, view, namedLights(kSide * kSide * perPixel));
    t.count("reservoirs", perPixel).param("neighbours", "16").param("radius", std::to_string(radius));
    t.input("reservoirs", named(kSide * kSide, perPixel));
    std::set<std::pair<int, int>> offsets;
    for (int frame = 0; frame < 8; ++frame) {
      t.run();
      const std::vector<Reservoir> out = t.output<Reservoir>("reservoirs");
      ASSERT_EQ(out.size(), kSide * kSide * perPixel);
      for (uint32_t i = 0; i < out.size(); ++i) {
        ASSERT_EQ(lightOf(out[i]) % perPixel, i % perPixel);
        const uint32_t here = i / perPixel, from = lightOf(out[i]) / perPixel;
        const int x = static_cast<int>(from % kSide) - static_cast<int>(here % kSide);
        const int y = static_cast<int>(from / kSide) - static_cast<int>(here / kSide);
        // From the centre of this pixel, the nearest point of that one lies within the radius.
        ASSERT_LE(std::hypot(std::max(std::abs(x) - 0.5, 0.0), std::max(std::abs(y) - 0.5, 0.0)), radius);
        offsets.insert({x, y});
        // A disc of radius 1024 misses the picture almost always; at most all of 16 tries hit.
        ASSERT_GE(out[i].confidence, 1.0f);
        ASSERT_LE(out[i].confidence, 17.0f);
      }
    }
    // Every pixel that the disc around a pixel's centre touches, or nearly so.
    const std::map<double, size_t> least = {{1.0, 9}, {4.0, 60}, {9.5, 250}, {1024.0, 1}};
    EXPECT_GE(offsets.size(), least.at(radius));
  }
}

/// Pairs of pixels with nothing around them: the only neighbour that one can find is the other, and the confidence that
/// comes out tells how often it was found.
struct Pairs {
  static constexpr uint32_t kStep = 4;
  View view;
  std::vector<size_t> left;
  /// `leftSurface` and `rightSurface` at the two pixels of every pair.
  Pairs(const scene::Camera& camera, const PackedSurface& leftSurface, const PackedSurface& rightSurface)
      : view(kSide, kSide, camera) {
    for (uint32_t y = 1; y < kSide; y += kStep) {
      for (uint32_t x = 1; x + 1 < kSide; x += kStep) {
        view.set(x, y, leftSurface);
        view.set(x + 1, y, rightSurface);
        left.push_back(size_t{y} * kSide + x);
      }
    }
  }
  std::vector<Reservoir> reservoirs(const Reservoir& first, const Reservoir& second) const {
    std::vector<Reservoir> result(view.pixels(), Reservoir{});
    for (const size_t i : left) {
      result[i] = first;
      result[i + 1] = second;
    }
    return result;
  }
};

// Each threshold alone, the others open.
TEST(RestirSpatial, UnlikeSurfacesAreRejected) {
  const auto tilted = [](double degrees) {
    return Vec(std::sin(glm::radians(degrees)), 0.0, std::cos(glm::radians(degrees)));
  };
  Finish paler, palest;
  paler.diffuse.z += 0.18;
  palest.diffuse.z += 0.22;
  const Vec up(0, 0, 1);
  const PackedSurface here = packSurface(5.0, up, up, {});
  const struct {
    PackedSurface other;
    const char* rejectedBy;
  } cases[] = {{here, ""},
               {packSurface(5.45, up, up, {}), ""},
               {packSurface(5.6, up, up, {}), "depth"},
               {packSurface(4.4, up, up, {}), "depth"},
               {packSurface(5.0, up, tilted(24.5), {}), ""},
               {packSurface(5.0, up, tilted(25.5), {}), "normal"},
               {packSurface(5.0, up, up, paler), ""},
               {packSurface(5.0, up, up, palest), "albedo"},
               {nothing(), "all"}};
  for (const std::string only : {"depth", "normal", "albedo"}) {
    PassTest t("restir_di.Spatial");
    t.param("depthThreshold", only == "depth" ? "0.1" : "10").param("normalThreshold", only == "normal" ? "25" : "180");
    t.param("albedoThreshold", only == "albedo" ? "0.2" : "1").param("radius", "1.5").param("neighbours", "16");
    bool first = true;
    for (const auto& c : cases) {
      const Pairs pairs(frontCamera(5e-4), here, c.other);
      if (std::exchange(first, false)) show(t, pairs.view, namedLights(4));
      t.input("surface", pairs.view.packed())
          .input("reservoirs", pairs.reservoirs({0, 0, 1.0f, 1.0f}, {1, 0, 1.0f, 1.0f}));
      t.run();
      const std::vector<Reservoir> out = t.output<Reservoir>("reservoirs");
      float most = 0.0f;
      for (const size_t i : pairs.left) most = std::max(most, out[i].confidence);
      const std::string by = c.rejectedBy;
      if (by == only || by == "all")
        EXPECT_EQ(most, 1.0f) << only << ", case " << &c - cases;
      else
        EXPECT_GT(most, 1.0f) << only << ", case " << &c - cases;
      // Nothing comes out where there is no surface.
      EXPECT_EQ(out[0].confidence, 0.0f);
      EXPECT_EQ(out[0].weight, 0.0f);
    }
  }
}

// A pixel and its only neighbour, found k times of 16: W to 3e-4 of what theory gives for those k + 1 reservoirs,
// and how often each survives. Wide angle, gloss and unlike normals: the neighbour's own view vector matters. False
// alarms: 1e-4.
TEST(RestirSpatial, MergesByHand) {
  Finish glossy;
  glossy.f0 = {0.6, 0.5, 0.4};
  glossy.roughness = 0.3;
  const scene::Camera camera = frontCamera(20.0);
  const Pairs pairs(camera, packSurface(5.0, {0, 0, 1}, {-0.2, 0, 1}, glossy),
                    packSurface(6.0, {0, 0, 1}, {0.4, 0.1, 1}, glossy));
  const scene::Scene scene =
      pointScene({{{1, 1, 4}, {3, 3, 3}}, {{-0.5f, -1, 4.5f}, {2, 3, 4}}, {{9, 0, 3}, {9, 9, 9}}});
  const struct {
    Reservoir own, other;
  } cases[] = {{{0, 0, 0.7f, 2}, {1, 0, 1.9f, 3}}, {{1, 0, 0.7f, 1}, {0, 0, 1.9f, 5}},
               {{0, 0, 0.0f, 4}, {1, 0, 1.9f, 3}}, {{0, 0, 0.7f, 2}, {1, 0, 0.0f, 3}},
               {{2, 0, 0.7f, 2}, {1, 0, 0.5f, 3}}, {{0, 0, 0.7f, 2}, {2, 0, 0.5f, 3}},
               {{0, 0, 0.0f, 1}, {0, 0, 0.0f, 1}}};
  for (const oracle::Mis mis : oracle::kEveryMis) {
    SCOPED_TRACE(oracle::nameOf(mis));
    PassTest t("restir_di.Spatial");
    show(t, pairs.view, scene);
    t.param("mis", oracle::nameOf(mis)).param("radius", "1.5").param("neighbours", "16");
    t.param("depthThreshold", "10").param("normalThreshold", "180").seed(2);
    const oracle::World world(t.prepared());
    Sample survived;
    std::set<int> found;
    for (size_t c = 0; c < std::size(cases); ++c) {
      const Reservoir &a = cases[c].own, &b = cases[c].other;
      t.input("reservoirs", pairs.reservoirs(a, b));
      for (int frame = 0; frame < 24; ++frame) {
        t.run();
        const std::vector<Reservoir> out = t.output<Reservoir>("reservoirs");
        for (const size_t i : pairs.left) {
          const double times = (out[i].confidence - a.confidence) / b.confidence;
          const int k = static_cast<int>(std::lround(times));
          ASSERT_EQ(times, k) << "case " << c;
          ASSERT_LE(k, 16);
          found.insert(k);
          std::vector<oracle::MergeInput> inputs;
          for (int j = 0; j <= k; ++j) {
            const Reservoir& r = j == 0 ? a : b;
            oracle::MergeInput input{r.confidence, r.weight, {world.target(pairs.view[i], r.light, r.place)}};
            input.targets.resize(k + 1, world.target(pairs.view[i + 1], r.light, r.place));
            inputs.push_back(input);
          }
          const oracle::Merged merged = oracle::merge(inputs, mis);
          if (merged.sum == 0.0) {
            ASSERT_EQ(out[i].weight, 0.0f);
            continue;
          }
          const double p = 1.0 - merged.probability[0];
          // By z a sample that its own domain doesn't contain leaves nothing when it is chosen.
          const bool nothing = mis == oracle::Mis::Z && k > 0 && merged.weight[1] == 0.0;
          const bool second = a.weight == 0.0f || (nothing ? out[i].weight == 0.0f : lightOf(out[i]) == b.light);
          if (second && nothing)
            ASSERT_EQ(out[i].weight, 0.0f);
          else
            ASSERT_NEAR(out[i].weight / merged.weight[second ? 1 : 0], 1.0, 3e-4) << "case " << c << ", found " << k;
          if (p > 1e-9 && p < 1.0 - 1e-9)
            survived.add(((second ? 1.0 : 0.0) - p) / std::sqrt(p * (1.0 - p)));
          else
            ASSERT_EQ(second, p > 0.5);
        }
      }
    }
    EXPECT_GE(found.size(), 7u);
    EXPECT_TRUE(agrees(survived, 0.0, 0.5e-4));
  }
}

// Confidences add up, iteration by iteration: with q the chance that one try finds the other of a pair, their
// expectations follow (c, d) → (c + n q d, d + n q c). Chance of a false alarm: 1e-4 over all.
TEST(RestirSpatial, ConfidencesAddUp) {
  const PackedSurface surface = packSurface(5.0, {0, 0, 1}, {0, 0, 1}, {});
  const Pairs pairs(frontCamera(5e-4), surface, surface);
  const double radius = 1.5;
  // Share of the disc that lies in the pixel beside, by counting.
  double q = 0.0;
  constexpr int kGrid = 2000;
  for (int i = 0; i < kGrid * kGrid; ++i) {
    const double x = ((i % kGrid + 0.5) / kGrid * 2.0 - 1.0) * radius,
                 y = ((i / kGrid + 0.5) / kGrid * 2.0 - 1.0) * radius;
    if (std::hypot(x, y) < radius && x >= 0.5 && x < 1.5 && std::abs(y) < 0.5) q += 1.0;
  }
  q /= kGrid * kGrid * 3.14159265358979 / 4.0;
  const std::pair<int, int> settings[] = {{1, 1}, {1, 16}, {2, 5}, {3, 3}, {4, 2}};
  for (const auto& [iterations, neighbours] : settings) {
    SCOPED_TRACE(testing::Message() << iterations << " iterations, " << neighbours << " neighbours");
    PassTest t("restir_di.Spatial");
    show(t, pairs.view, namedLights(2));
    t.param("iterations", std::to_string(iterations))
        .param("neighbours", std::to_string(neighbours))
        .param("radius", "1.5");
    t.input("reservoirs", pairs.reservoirs({0, 0, 1.0f, 1.0f}, {1, 0, 0.0f, 3.0f})).seed(1);
    double c = 1.0, d = 3.0;
    for (int i = 0; i < iterations; ++i) {
      const double old = c;
      c += neighbours * q * d;
      d += neighbours * q * old;
    }
    Sample left, right;
    for (int frame = 0; frame < 40; ++frame) {
      t.run();
      const std::vector<Reservoir> out = t.output<Reservoir>("reservoirs");
      for (const size_t i : pairs.left) {
        left.add(out[i].confidence);
        right.add(out[i + 1].confidence);
      }
    }
    EXPECT_TRUE(agrees(left, c, 1e-4, 10));
    EXPECT_TRUE(agrees(right, d, 1e-4, 10));
  }
}

}  // namespace
}  // namespace weir::test
