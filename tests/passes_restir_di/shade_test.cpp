// restir_di.Shade: f · V · W against glTF's BSDF and the lights' formulas in double precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "setup.h"

namespace weir::test {
namespace {

using oracle::Vec;
using passes::Reservoir;

constexpr uint32_t kSide = 64;

Vec pixelOf(const std::vector<float>& picture, size_t i) {
  return {picture[4 * i], picture[4 * i + 1], picture[4 * i + 2]};
}

/// Surfaces of every kind: roughness 0 … 1, dielectric and metal, grazing views, shading normals away from the
/// geometric one; for half of them the normal is near the half vector of `light`, where a highlight is.
View randomSurfaces(const oracle::World& world, std::vector<Reservoir>& reservoirs, oracle::Random& random) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const auto unit = [&] {
    const double z = 2.0 * uniform(random) - 1.0, a = 6.283185307 * uniform(random);
    return Vec(std::sqrt(1.0 - z * z) * std::cos(a), std::sqrt(1.0 - z * z) * std::sin(a), z);
  };
  View view(kSide, kSide, frontCamera(3.0));
  reservoirs.clear();
  for (uint32_t i = 0; i < kSide * kSide; ++i) {
    const Vec ray = oracle::direction(view.camera(), i % kSide + 0.5, i / kSide + 0.5, kSide, kSide);
    const double distance = 4.0 + 4.0 * uniform(random);
    Reservoir r{static_cast<uint32_t>(random() % world.lights().size()), static_cast<uint32_t>(random()), 0.0f, 1.0f};
    r.weight = static_cast<float>(0.1 + uniform(random));
    Finish finish;
    finish.roughness = i % 5 == 0 ? 0.0 : i % 5 == 1 ? 1.0 : uniform(random);
    const Vec base(uniform(random), uniform(random), uniform(random));
    const double metallic = i % 3 == 0 ? 0.0 : i % 3 == 1 ? 1.0 : uniform(random);
    finish.diffuse = base * (1.0 - metallic);
    finish.f0 = glm::mix(Vec(0.04), base, metallic);
    Vec normal = unit();
    if (i % 2 == 0) {
      const Vec point = Vec(view.camera().eye) + distance * ray;
      const Vec l = world.arriving(r.light, oracle::barycentrics(r.place), point).direction;
      normal = glm::normalize(l - ray) + 2.0 * finish.roughness * finish.roughness * uniform(random) * unit();
    }
    normal = glm::normalize(normal);
    if (glm::dot(normal, ray) > 0.0) normal = i % 7 == 0 ? normal - 2.0 * glm::dot(normal, ray) * ray : -normal;
    Vec geometric = glm::normalize(normal + 0.3 * unit());
    if (glm::dot(geometric, ray) > 0.0) geometric = -geometric;
    view.set(i % kSide, i / kSide, packSurface(distance, geometric, normal, finish));
    reservoirs.push_back(r);
  }
  return view;
}

TEST(RestirShade, FollowsTheBsdfAndTheLights) {
  oracle::Random random(8);
  PassTest t("restir_di.Shade");
  t.leaveOpen("light");
  const scene::Scene scene = smallScene({});
  const oracle::World world(scene::prepareScene(scene));
  std::vector<Reservoir> reservoirs;
  int lit = 0, bright = 0;
  for (int round = 0; round < 4; ++round) {
    const View view = randomSurfaces(world, reservoirs, random);
    if (round == 0) show(t, view, scene);
    t.param("visibility", "false").input("surface", view.packed()).input("reservoirs", reservoirs).run();
    const std::vector<float> out = t.output<float>("color");
    for (size_t i = 0; i < view.pixels(); ++i) {
      const Vec expected =
          world.contribution(view[i], reservoirs[i].light, reservoirs[i].place) * double(reservoirs[i].weight);
      const Vec actual = pixelOf(out, i);
      lit += oracle::luminance(expected) > 0.0 ? 1 : 0;
      bright += oracle::luminance(expected) > 100.0 ? 1 : 0;
      // A mirror's highlight is 1/2048 wide: positions and directions in single precision are what limits it.
      const double tolerance = view[i].roughness < 0.1 ? 5e-3 : 1e-3;
      // At the horizon the cosine itself is a difference of rounded numbers.
      const double floor =
          1e-5 * oracle::luminance(Vec(world.lights()[reservoirs[i].light].radiance)) * reservoirs[i].weight;
      for (int c = 0; c < 3; ++c) {
        ASSERT_NEAR(actual[c], expected[c], tolerance * expected[c] + floor)
            << "pixel " << i << ", light " << reservoirs[i].light << ", roughness " << view[i].roughness;
      }
      ASSERT_EQ(out[4 * i + 3], 1.0f);
    }
  }
  EXPECT_GT(lit, 4000);
  EXPECT_GT(bright, 100);
}

// With the final ray a hidden sample is black, one that is marked as seen from this pixel is not asked about again, and
// without the ray everything is lit. Emission is added, with and without a surface.
TEST(RestirShade, ShadowsAndEmission) {
  View view = planeView(kSide, kSide, frontCamera());
  for (uint32_t y = 0; y < kSide; y += 9) view.set(y, y, nothing());
  oracle::Random random(2);
  std::vector<float> emission;
  for (size_t i = 0; i < view.pixels(); ++i) {
    const auto value = static_cast<float>(i % 10);
    emission.insert(emission.end(), {value, 2.0f * value, 0.5f, 1.0f});
  }
  const scene::Scene scene = smallScene({});
  const oracle::World world(scene::prepareScene(scene));
  std::vector<Reservoir> reservoirs;
  for (size_t i = 0; i < view.pixels(); ++i) {
    reservoirs.push_back(
        {static_cast<uint32_t>(random() % world.lights().size()), static_cast<uint32_t>(random()), 0.5f, 1.0f});
    if (i % 3 == 0) reservoirs.back().light |= 0x80000000u;
  }
  for (const bool visibility : {true, false}) {
    PassTest t("restir_di.Shade");
    t.leaveOpen("light");
    show(t, view, scene);
    t.param("visibility", visibility ? "true" : "false")
        .input("emission", emission)
        .input("reservoirs", reservoirs)
        .run();
    const std::vector<float> out = t.output<float>("color");
    int hidden = 0, wrong = 0;
    for (size_t i = 0; i < view.pixels(); ++i) {
      Vec expected = pixelOf(emission, i);
      const Reservoir& r = reservoirs[i];
      if (view.has(i)) {
        const bool seen = !visibility || isSeen(r) || world.sees(view[i], lightOf(r), r.place);
        hidden += seen ? 0 : 1;
        if (seen) expected += world.contribution(view[i], lightOf(r), r.place) * double(r.weight);
      }
      const Vec off = glm::abs(pixelOf(out, i) - expected);
      wrong += std::max(off.x, std::max(off.y, off.z)) > 1e-3 * oracle::luminance(expected) + 1e-5 ? 1 : 0;
    }
    EXPECT_EQ(hidden > 200, visibility);
    // The edge of a shadow may fall either way in single precision.
    EXPECT_LE(wrong, visibility ? 2 : 0);
  }
}

// Several reservoirs: their mean. Null ones count as black.
TEST(RestirShade, MeanOverReservoirs) {
  const View view = planeView(8, 8, frontCamera());
  const scene::Scene scene = smallScene({});
  const oracle::World world(scene::prepareScene(scene));
  oracle::Random random(3);
  for (const int perPixel : {2, 3, 4}) {
    std::vector<Reservoir> reservoirs;
    for (size_t i = 0; i < view.pixels() * perPixel; ++i) {
      const bool null = random() % 3 == 0;
      reservoirs.push_back(
          {static_cast<uint32_t>(random() % 8), static_cast<uint32_t>(random()), null ? 0.0f : 0.25f, 1.0f});
    }
    PassTest t("restir_di.Shade");
    t.leaveOpen("light");
    show(t, view, scene);
    t.param("visibility", "false").count("reservoirs", perPixel).input("reservoirs", reservoirs).run();
    const std::vector<float> out = t.output<float>("color");
    for (size_t i = 0; i < view.pixels(); ++i) {
      Vec expected(0.0);
      for (int k = 0; k < perPixel; ++k) {
        const Reservoir& r = reservoirs[i * perPixel + k];
        expected += world.contribution(view[i], r.light, r.place) * double(r.weight) / double(perPixel);
      }
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(pixelOf(out, i)[c], expected[c], 1e-3 * expected[c] + 1e-6);
    }
  }
}

TEST(RestirShade, NonFiniteReservoirsGiveEmissionOnly) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  const Reservoir poison[] = {{0, 0, nan, 1},        {0, 0, infinity, 1},       {1, 0, -infinity, 1}, {0, 0, -1, 1},
                              {0x7fffffff, 0, 1, 1}, {0xffffffff, 0, nan, nan}, {8, 0, 1, 1},         {0, 0, 1, nan},
                              {0, 0, 1, infinity},   {0x80000000, 0, nan, 1},   {0xdeadbeef, 0, 1, 1}};
  const View view = planeView(16, 16, frontCamera());
  for (const char* visibility : {"true", "false"}) {
    PassTest t("restir_di.Shade");
    t.leaveOpen("light");
    show(t, view, smallScene({}));
    std::vector<Reservoir> reservoirs;
    std::vector<float> emission;
    for (size_t i = 0; i < view.pixels(); ++i) {
      reservoirs.push_back(poison[i % std::size(poison)]);
      emission.insert(emission.end(), {0.25f, 0.5f, 0.75f, 1.0f});
    }
    t.param("visibility", visibility).input("emission", emission).input("reservoirs", reservoirs).run();
    EXPECT_EQ(t.output<float>("color"), emission);
  }
}

}  // namespace
}  // namespace weir::test
