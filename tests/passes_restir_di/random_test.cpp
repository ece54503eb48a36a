// The random numbers behind restir_di.Initial, seen through the places that it picks on a lone light.
#include <gtest/gtest.h>

#include <cmath>

#include "setup.h"

namespace weir::test {
namespace {

using passes::Reservoir;

constexpr uint32_t kSide = 128;

class Places {
 public:
  Places() : view_(planeView(kSide, kSide, frontCamera(5e-4))), pass_("restir_di.Initial") {
    scene::Scene scene = smallScene({.points = false, .spot = false, .blocker = false});
    scene.meshes.back().primitives[0].indices.resize(3);  // one triangle: the only light
    pass_.size(kSide, kSide).scene(std::move(scene)).camera(view_.camera()).input("surface", view_.packed());
    pass_.param("candidates", "1").param("visibility", "false").param("triangles", "area");
  }
  std::vector<uint32_t> at(uint32_t seed, uint32_t frame) {
    pass_.seed(seed).frame(frame).run();
    std::vector<uint32_t> places;
    for (const Reservoir& r : pass_.output<Reservoir>("reservoirs")) {
      EXPECT_GT(r.weight, 0.0f);
      places.push_back(r.place);
    }
    return places;
  }

 private:
  View view_;
  PassTest pass_;
};

double first(uint32_t place) {
  return (place & 0xffffu) / 65536.0 - 0.5;
}
double second(uint32_t place) {
  return (place >> 16) / 65536.0 - 0.5;
}

TEST(RestirRandom, EqualSeedAndFrameGiveEqualPictures) {
  Places places;
  const std::vector<uint32_t> once = places.at(5, 9);
  const auto same = [&](const std::vector<uint32_t>& other) {
    size_t equal = 0;
    for (size_t i = 0; i < once.size(); ++i) equal += once[i] == other[i] ? 1 : 0;
    return equal;
  };
  EXPECT_EQ(same(places.at(5, 9)), once.size());
  // Two of 16384 pixels agree by chance with probability below 1e-5.
  EXPECT_LE(same(places.at(5, 10)), 1u);
  EXPECT_LE(same(places.at(6, 9)), 1u);
  EXPECT_LE(same(places.at(9, 5)), 1u);             // seed and frame don't stand in for each other
  EXPECT_EQ(same(Places().at(5, 9)), once.size());  // nothing is left over from what ran before
}

// Correlation of uniform numbers with those of the pixels beside, of the next frame, of the next seed and of the other
// dimension: below 0.01, which for 16 frames of 128² pixels is 5.1 standard deviations: all 12 together raise a false
// alarm with 4e-6.
TEST(RestirRandom, NeighboursAreUncorrelated) {
  Places places;
  constexpr int kFrames = 16;
  std::vector<std::vector<uint32_t>> frames, seeds;
  for (uint32_t i = 0; i <= kFrames; ++i) frames.push_back(places.at(1, i));
  for (uint32_t i = 0; i <= kFrames; ++i) seeds.push_back(places.at(i, 100));
  double sums[12] = {}, squares = 0.0;
  uint64_t count = 0;
  for (int f = 0; f < kFrames; ++f) {
    for (uint32_t y = 0; y + 1 < kSide; ++y) {
      for (uint32_t x = 0; x + 1 < kSide; ++x) {
        const size_t i = size_t{y} * kSide + x;
        const uint32_t here = frames[f][i], seeded = seeds[f][i];
        const uint32_t others[] = {frames[f][i + 1], frames[f][i + kSide], frames[f][i + kSide + 1], frames[f + 1][i]};
        for (int k = 0; k < 4; ++k) {
          sums[2 * k] += first(here) * first(others[k]);
          sums[2 * k + 1] += second(here) * second(others[k]);
        }
        sums[8] += first(seeded) * first(seeds[f + 1][i]);
        sums[9] += second(seeded) * second(seeds[f + 1][i]);
        sums[10] += first(here) * second(here);
        sums[11] += first(here) * second(frames[f][i + 1]);
        squares += first(here) * first(here);
        ++count;
      }
    }
  }
  EXPECT_NEAR(squares / static_cast<double>(count), 1.0 / 12.0, 5e-4);
  for (const double sum : sums) EXPECT_LT(std::abs(sum / squares), 0.01);
}

}  // namespace
}  // namespace weir::test
