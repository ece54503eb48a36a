// The light of all merged samples: what Spatial says of it, and what Shade makes of that.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "laboratory.h"
#include "setup.h"
#include "support/small_scenes.h"

namespace weir::test {
namespace {

using oracle::Vec;
using passes::Reservoir;

constexpr uint32_t kSide = 48;

Vec pixelOf(const std::vector<float>& picture, size_t i) {
  return {picture[4 * i], picture[4 * i + 1], picture[4 * i + 2]};
}

void expectNear(const Vec& actual, const Vec& expected, double scale, const std::string& where) {
  for (int c = 0; c < 3; ++c) ASSERT_NEAR(actual[c], expected[c], 1e-4 * scale) << where << ", channel " << c;
}

// Where all pixels hold the same sample and weight, weights that sum to one leave f W of it, whoever the neighbours
// are.
TEST(RestirLight, WeightsSumToOne) {
  const View view = planeView(kSide, kSide, frontCamera());
  const scene::Scene scene = smallScene({.blocker = false});
  const oracle::World world(scene::prepareScene(scene));
  for (const char* mis : {"biased", "z", "balance", "pairwise"}) {
    for (const char* iterations : {"1", "3"}) {
      PassTest t("restir_di.Spatial");
      show(t, view, scene);
      std::vector<Reservoir> reservoirs(view.pixels(), Reservoir{0, 12345u << 7u, 0.7f, 1.0f});
      t.param("mis", mis).param("iterations", iterations).param("radius", "9").param("neighbours", "6");
      t.input("reservoirs", reservoirs).run();
      const std::vector<float> light = t.output<float>("light");
      double sum = 0.0;
      for (size_t i = 0; i < view.pixels(); ++i) {
        const Vec expected = world.contribution(view[i], reservoirs[i].light, reservoirs[i].place) * 0.7;
        expectNear(pixelOf(light, i), expected, oracle::luminance(expected) + 1e-6,
                   std::string(mis) + " pixel " + std::to_string(i));
        sum += oracle::luminance(expected);
      }
      EXPECT_GT(sum, 0.0) << "nothing is lit";
    }
  }
}

// A pixel without a sample of its own keeps what it chose alone: with it, what is hidden would leave others' light
// behind.
TEST(RestirLight, WithoutOwnSampleTheChosenOneStandsAlone) {
  const View view = planeView(kSide, kSide, frontCamera());
  const scene::Scene scene = smallScene({.blocker = false});
  const oracle::World world(scene::prepareScene(scene));
  PassTest t("restir_di.Spatial");
  show(t, view, scene);
  std::vector<Reservoir> reservoirs;
  for (size_t i = 0; i < view.pixels(); ++i) {
    const bool has = (i % kSide) % 2 == 0;
    reservoirs.push_back(
        {has ? static_cast<uint32_t>(i / kSide % world.lights().size()) : 0u, 77u << 20u, has ? 1.0f : 0.0f, 1.0f});
  }
  t.param("radius", "7").param("neighbours", "8").input("reservoirs", reservoirs).run();
  const std::vector<float> light = t.output<float>("light");
  const std::vector<Reservoir> out = t.output<Reservoir>("reservoirs");
  int alone = 0;
  for (size_t i = 0; i < view.pixels(); ++i) {
    if (reservoirs[i].weight > 0.0f) continue;
    Vec expected(0.0);
    if (out[i].weight > 0.0f) {
      expected = world.contribution(view[i], lightOf(out[i]), out[i].place) * double(out[i].weight);
      ++alone;
    }
    expectNear(pixelOf(light, i), expected, oracle::luminance(expected) + 1e-6, "pixel " + std::to_string(i));
  }
  EXPECT_GT(alone, 300);
}

// Shade: light + f W (V - 1) + emission, whatever `light` is; one sample a pixel and several.
TEST(RestirLight, ShadeTakesBackWhatIsHidden) {
  const View view = planeView(kSide, kSide, frontCamera());
  const scene::Scene scene = smallScene({.veil = true});
  const oracle::World world(scene::prepareScene(scene));
  for (const uint32_t samples : {1u, 3u}) {
    oracle::Random random(samples);
    std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
    std::vector<Reservoir> reservoirs;
    std::vector<float> light, emission;
    for (size_t i = 0; i < view.pixels(); ++i) {
      for (int c = 0; c < 4; ++c) {
        light.push_back(3.0f * uniform(random));
        emission.push_back(uniform(random));
      }
      for (uint32_t k = 0; k < samples; ++k) {
        reservoirs.push_back({static_cast<uint32_t>(random() % world.lights().size()), static_cast<uint32_t>(random()),
                              random() % 4 == 0 ? 0.0f : 0.5f, 1.0f});
        if (random() % 5 == 0) reservoirs.back().light |= 0x80000000u;
      }
    }
    PassTest t("restir_di.Shade");
    show(t, view, scene);
    t.count("reservoirs", samples)
        .input("reservoirs", reservoirs)
        .input("light", light)
        .input("emission", emission)
        .run();
    const std::vector<float> out = t.output<float>("color");
    int hidden = 0, half = 0, wrong = 0;
    for (size_t i = 0; i < view.pixels(); ++i) {
      Vec expected = pixelOf(light, i) + pixelOf(emission, i);
      for (uint32_t k = 0; k < samples; ++k) {
        const Reservoir& r = reservoirs[i * samples + k];
        if (!(r.weight > 0.0f) || isSeen(r)) continue;
        const Vec f = world.contribution(view[i], lightOf(r), r.place) * double(r.weight) / double(samples);
        const double through = world.transmittance(view[i], lightOf(r), r.place);
        expected -= f * (1.0 - through);
        hidden += through == 0.0 && oracle::luminance(f) > 0.0 ? 1 : 0;
        half += through > 0.0 && through < 1.0 ? 1 : 0;
      }
      const Vec off = glm::abs(pixelOf(out, i) - expected);
      wrong += std::max(off.x, std::max(off.y, off.z)) > 1e-3 * (1.0 + oracle::luminance(expected)) ? 1 : 0;
    }
    EXPECT_GT(hidden, 50);
    EXPECT_GT(half, 10);
    // The edge of a shadow may fall either way in single precision.
    EXPECT_LE(wrong, 2 * static_cast<int>(samples));
  }
}

// What came in goes out, marked with what the final rays found, and with its weight: hidden samples too, as the merges'
// domains hold them.
TEST(RestirLight, ShadeMarksWhatRaysFound) {
  constexpr uint32_t kSeen = 0x80000000u, kHidden = 0x40000000u;
  View view = planeView(kSide, kSide, frontCamera());
  for (uint32_t i = 0; i < kSide; i += 5) view.set(i, i, nothing());
  const scene::Scene scene = smallScene({.veil = true});
  const oracle::World world(scene::prepareScene(scene));
  oracle::Random random(6);
  std::vector<Reservoir> reservoirs;
  for (size_t i = 0; i < view.pixels(); ++i) {
    reservoirs.push_back({static_cast<uint32_t>(random() % world.lights().size()), static_cast<uint32_t>(random()),
                          random() % 4 == 0 ? 0.0f : 0.5f, 2.0f});
    if (random() % 4 == 0) reservoirs.back().light |= random() % 2 == 0 ? kSeen : kHidden;
  }
  PassTest t("restir_di.Shade");
  t.leaveOpen("light");
  show(t, view, scene);
  t.input("reservoirs", reservoirs).run();
  const std::vector<Reservoir> out = t.output<Reservoir>("reservoirs");
  int seen = 0, hidden = 0, half = 0, wrong = 0;
  for (size_t i = 0; i < view.pixels(); ++i) {
    if (!view.has(i)) {
      ASSERT_EQ(out[i].confidence, 0.0f) << i;
      continue;
    }
    const Reservoir& r = reservoirs[i];
    ASSERT_EQ(out[i].weight, r.weight) << i;
    ASSERT_EQ(out[i].confidence, r.confidence) << i;
    if (!(r.weight > 0.0f) || oracle::luminance(world.contribution(view[i], lightOf(r), r.place)) == 0.0) continue;
    ASSERT_EQ(lightOf(out[i]), lightOf(r)) << i;
    ASSERT_EQ(out[i].place, r.place) << i;
    const double through = isSeen(r) ? 1.0 : world.transmittance(view[i], lightOf(r), r.place);
    const uint32_t marks = through >= 1.0 ? kSeen : through <= 0.0 ? kHidden : 0u;
    wrong += (out[i].light & (kSeen | kHidden)) == marks ? 0 : 1;
    ++(marks == kSeen ? seen : marks == kHidden ? hidden : half);
  }
  EXPECT_GT(seen, 300);
  EXPECT_GT(hidden, 50);
  EXPECT_GT(half, 10);
  EXPECT_LE(wrong, 2) << "the edge of a shadow may fall either way in single precision";
}

/// Rays of the frame after so many, of a graph over a floor with a block under two lamps.
uint64_t raysOfFrame(uint32_t frames, const std::vector<std::string>& set, float step) {
  Builder b;
  scene::Material grey, lamp;
  grey.baseColor = {0.6f, 0.6f, 0.6f, 1.0f};
  grey.metallic = 0.0f;
  lamp.emission = {9, 9, 9};
  const int greyOne = b.material(grey), lampOne = b.material(lamp);
  b.add(quad({-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}, greyOne));
  b.add(quad({-0.6f, 0.5f, 0.6f}, {0.6f, 0.5f, 0.6f}, {0.6f, 0.5f, -0.6f}, {-0.6f, 0.5f, -0.6f}, greyOne));
  for (const float x : {-1.0f, 1.0f})
    b.add(quad({x - 0.3f, 2, -0.3f}, {x + 0.3f, 2, -0.3f}, {x + 0.3f, 2, 0.3f}, {x - 0.3f, 2, 0.3f}, lampOne));
  const std::shared_ptr<gpu::Device> device = validatedDevice();
  const ExpectNoValidationMessages guard(*device);
  Registry registry({std::filesystem::path(binaryPath("bin"))});
  const scene::PreparedScene prepared = scene::prepareScene(b.scene);
  const scene::SceneGpu gpu(*device, b.scene, prepared, device->capabilities().accelerationStructure);
  shader::Compiler compiler;
  execute::ExecutorOptions options;
  options.backend = trace::chooseBackend("auto", *device);
  options.countRays = true;
  execute::Executor executor(
      *device, compiler, registry, gpu,
      graph::compileFile(sourcePath("graphs/restir_di.json"), {.set = set, .enable = {}, .disable = {"spatial"}},
                         registry.catalog(), kSide, kSide),
      options);
  for (uint32_t f = 0; f < frames; ++f)
    executor.frame({lookAt({0.2f + step * static_cast<float>(f), 1.4f, 3.5f}, {0, 0.2f, 0}, 50), f, 5, false});
  executor.finish();
  return executor.rays();
}

// Where nothing moves, what rays have found holds on: temporal reuse with rays traces next to none of its own, and the
// final ray is known. A camera that moves makes them all anew.
TEST(RestirLight, StillPicturesTraceFewerRays) {
  const std::vector<std::string> rays = {"temporal.visibilityRays=true", "gbuffer.jitter=false"};
  const uint64_t first = raysOfFrame(1, rays, 0.0f), still = raysOfFrame(6, rays, 0.0f),
                 moving = raysOfFrame(6, rays, 0.004f);
  EXPECT_LT(still, first + first / 50);
  EXPECT_GT(moving, first + first / 3);
}

}  // namespace
}  // namespace weir::test
