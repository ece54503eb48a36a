// Merges with visibility in the weights, sample by sample: points behind an opaque square and behind one that lets a
// part through, as seen from this frame's surface and from last frame's.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>

#include "setup.h"

namespace weir::test {
namespace {

using oracle::Vec;
using passes::Reservoir;

constexpr uint32_t kSide = 32, kLights = 96;
constexpr uint32_t kSeen = 0x80000000u;

/// Only point lights, anywhere in front of the two squares.
scene::Scene veiledPoints() {
  scene::Scene scene = smallScene({.points = false, .spot = false, .quad = false, .veil = true});
  oracle::Random random(12);
  std::uniform_real_distribution<float> across(-3.0f, 3.0f), up(1.5f, 2.5f), power(1.0f, 6.0f);
  for (uint32_t i = 0; i < kLights; ++i) {
    scene::PunctualLight light;
    light.position = {across(random), across(random), up(random)};
    light.intensity = {power(random), power(random), power(random)};
    scene.lights.push_back(light);
  }
  return scene;
}

// W to 3e-4 of theory for whatever comes out; nothing comes out that is hidden here, or, by z, that was hidden where it
// comes from; seen is what nothing is before; and how often each survives. Chance of a false alarm: 1e-4 over all
// modes.
TEST(RestirMergeRays, EverySampleHasItsWeight) {
  scene::Camera camera = frontCamera(5e-4), previousCamera = camera;
  previousCamera.eye.x = -1.2f;
  const View view = planeView(kSide, kSide, camera), before = planeView(kSide, kSide, previousCamera);
  for (const oracle::Mis mis : oracle::kEveryMis) {
    SCOPED_TRACE(oracle::nameOf(mis));
    PassTest t("restir_di.Temporal");
    show(t, view, veiledPoints());
    t.param("mis", oracle::nameOf(mis)).param("visibilityRays", "true").param("confidenceCap", "100");
    t.input("previousSurface", before.packed()).seed(5);
    const oracle::World world(t.prepared());
    ASSERT_EQ(world.lights().size(), kLights);
    const auto through = [&](const View& from, uint32_t light) { return world.transmittance(from[0], light, 0); };
    std::map<std::array<int, 2>, int> kinds;  // by transmittance here and there, in tenths
    Sample survived;
    oracle::Random random(77);
    std::uniform_real_distribution<float> weight(0.2f, 3.0f);
    for (int frame = 0; frame < 6; ++frame) {
      std::vector<Reservoir> own, history;
      for (size_t i = 0; i < view.pixels(); ++i) {
        const auto a = static_cast<uint32_t>(random() % kLights);
        const uint32_t b = (a + 1 + static_cast<uint32_t>(random() % (kLights - 1))) % kLights;
        own.push_back({a, 0, random() % 8 == 0 ? 0.0f : weight(random), 1.0f});
        history.push_back({b, 0, random() % 8 == 0 ? 0.0f : weight(random), 1.0f + static_cast<float>(random() % 9)});
        if (through(view, a) == 1.0 && own[i].weight > 0.0f && random() % 2 == 0) own[i].light |= kSeen;
        if (through(before, b) == 1.0 && history[i].weight > 0.0f && random() % 2 == 0) history[i].light |= kSeen;
      }
      t.input("reservoirs", own).input("history", history);
      t.camera(previousCamera).run();
      t.camera(camera).run();
      const std::vector<Reservoir> out = t.output<Reservoir>("reservoirs");
      for (size_t i = 0; i < out.size(); ++i) {
        const uint32_t lights[] = {lightOf(own[i]), lightOf(history[i])};
        const auto input = [&](const Reservoir& r) {
          const uint32_t light = lightOf(r);
          return oracle::MergeInput{
              r.confidence,
              r.weight,
              {world.target(view[i], light, 0), world.target(before[i], light, 0) * through(before, light)}};
        };
        const oracle::Merged merged = oracle::merge({input(own[i]), input(history[i])}, mis);
        ASSERT_EQ(out[i].confidence, static_cast<float>(merged.confidence));
        if (history[i].weight > 0.0f)
          ++kinds[{static_cast<int>(std::lround(10 * through(view, lights[1]))),
                   static_cast<int>(std::lround(10 * through(before, lights[1])))}];
        // Whether each can come out.
        bool can[2];
        for (int k = 0; k < 2; ++k)
          can[k] = merged.probability[k] > 0.0 && merged.weight[k] > 0.0 && through(view, lights[k]) > 0.0;
        if (!(out[i].weight > 0.0f)) {
          const bool nullable =
              merged.sum == 0.0 || (merged.probability[0] > 0.0 && !can[0]) || (merged.probability[1] > 0.0 && !can[1]);
          ASSERT_TRUE(nullable) << "pixel " << i;
          ASSERT_EQ(out[i].light, 0u);
          continue;
        }
        const int which = lightOf(out[i]) == lights[1] ? 1 : 0;
        ASSERT_EQ(lightOf(out[i]), lights[which]);
        ASSERT_TRUE(can[which]) << "pixel " << i;
        ASSERT_NEAR(out[i].weight / merged.weight[which], 1.0, 3e-4);
        ASSERT_EQ(isSeen(out[i]), through(view, lights[which]) == 1.0);
        const double p = merged.probability[1];
        if (can[0] && can[1]) survived.add((which - p) / std::sqrt(p * (1.0 - p)));
      }
    }
    EXPECT_GT(survived.count(), 300u);
    EXPECT_TRUE(agrees(survived, 0.0, 1e-4, 4));
    for (const std::array<int, 2>& kind : {std::array{10, 10}, {10, 0}, {10, 4}, {4, 10}, {0, 10}, {4, 4}, {0, 0}})
      EXPECT_GT(kinds[kind], 0) << kind[0] << ", " << kind[1];
  }
}

}  // namespace
}  // namespace weir::test
