// The environment in reservoirs: which places Initial picks, what they mean, and whether f · W averages to the light.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "setup.h"
#include "support/environment_oracle.h"
#include "support/small_scenes.h"

namespace weir::test {
namespace {

using passes::Reservoir;

constexpr double kPi = std::numbers::pi;

glm::vec3 spotted(uint32_t x, uint32_t y) {
  const auto u = [&](uint32_t c) { return static_cast<float>(uniformOf(x * 7919 + y * 104729 + c)); };
  return glm::vec3(u(1), u(2), u(3)) * (u(5) < 0.15f ? 30.0f : 1.0f);
}

/// A far away triangle gives the scene its size; nothing else is there.
scene::Scene skyScene(scene::Environment environment) {
  Builder b;
  b.add(quad({-9, -9, -9}, {-8, -9, -9}, {-8, -8, -9}, {-9, -8, -9}));
  b.scene.environment = std::move(environment);
  return b.scene;
}

// One candidate, and none by the BSDF: what comes out are the picks that the surface can see, with W = 1 / density.
TEST(RestirEnvironment, PlacesFollowTheTable) {
  const View view = planeView(64, 64, frontCamera(5e-4));
  for (const auto& [width, height] : {std::pair{1u, 1u}, {2u, 1u}, {9u, 7u}, {16u, 8u}, {300u, 5u}}) {
    SCOPED_TRACE(testing::Message() << width << " x " << height);
    PassTest t("restir_di.Initial");
    scene::Scene scene = skyScene(environmentOf(width, height, spotted, 1.0f, 0.4f));
    const scene::EnvironmentTable table = scene::tabulate(scene.environment);
    const EnvironmentOracle oracle(scene.environment);
    show(t, view, scene);
    t.param("candidates", "1").param("bsdfCandidates", "0").param("visibility", "false").seed(9);
    std::vector<scene::AliasCell> alias;
    for (const auto& c : table.cells) alias.push_back({c.threshold, c.alias});
    const std::vector<double> p = scene::aliasProbabilities(alias);

    // Only what lies before the plane z = 0 comes through: cells that are cut by it are left out of the count.
    std::vector<uint64_t> counts(p.size(), 0);
    std::array<uint64_t, 4> quarters{};
    uint64_t lit = 0, all = 0;
    for (int frame = 0; frame < 12; ++frame) {
      t.run();
      for (const Reservoir& r : t.output<Reservoir>("reservoirs")) {
        ++all;
        if (!(r.weight > 0.0f)) continue;
        const EnvironmentOracle::Place place = oracle.place(table, r.place);
        ASSERT_LT(place.cell, p.size());
        const glm::dvec3 d = oracle.direction(place.uv.x, place.uv.y);
        ASSERT_GT(d.z, -1e-3) << "below the surface";
        ASSERT_NEAR(r.weight / table.cells[place.cell].spread, 1.0, 1e-5);
        ++counts[place.cell];
        ++lit;
        // Within its cell a place is anywhere with the same probability.
        const uint32_t x = (r.place & 0xffffu) % (65536 / table.columns), y = (r.place >> 16) % (65536 / table.rows);
        ++quarters[(x * 2 >= 65536 / table.columns ? 1 : 0) + (y * 2 >= 65536 / table.rows ? 2 : 0)];
      }
    }
    std::vector<double> expected(p.size(), 0.0), kept;
    std::vector<uint64_t> keptCounts;
    double whole = 0.0;
    uint64_t wholeCount = 0;
    for (size_t i = 0; i < p.size(); ++i) {
      // Whether all of the cell is in front: its corners and edges.
      bool front = true;
      for (int k = 0; k < 81; ++k) {
        const glm::dvec2 uv((double(i % width) + (k % 9) / 8.0) / width, (double(i / width) + (k / 9) / 8.0) / height);
        front = front && oracle.direction(uv.x, uv.y).z > 1e-3;
      }
      if (!front) continue;
      kept.push_back(p[i]);
      keptCounts.push_back(counts[i]);
      whole += p[i];
      wholeCount += counts[i];
    }
    if (kept.size() > 1) {
      for (double& value : kept) value /= whole;
      EXPECT_GT(chiSquareP(keptCounts, kept), 1e-4);
      const double n = double(all);
      EXPECT_NEAR(double(wholeCount), whole * n, 5 * std::sqrt(n * whole * (1 - whole)) + 1);
    }
    EXPECT_GT(lit, all / 4);
  }
}

/// ∫ f · L by midpoints: luminance.
double truthOf(const oracle::Surface& s, const std::vector<EnvironmentOracle::Small>& lights) {
  oracle::Vec sum(0.0);
  for (const EnvironmentOracle::Small& light : lights) sum += oracle::bsdfCos(s, light.direction) * light.lux;
  return oracle::luminance(sum);
}

// The mean of f · W is the light, whichever way candidates come and whatever the surface.
TEST(RestirEnvironment, EstimatesAreUnbiased) {
  const scene::Scene scene = skyScene(environmentOf(24, 12, spotted, 1.0f, -1.1f));
  const scene::EnvironmentTable table = scene::tabulate(scene.environment);
  const EnvironmentOracle environment(scene.environment);
  struct Run {
    const char *candidates, *bsdf;
    Finish finish;
  };
  const Finish rough, glossy{{0.1, 0.1, 0.1}, {0.5, 0.6, 0.7}, 0.25};
  for (const Run& run : {Run{"1", "0", rough}, {"4", "1", rough}, {"1", "4", rough}, {"8", "2", glossy}}) {
    SCOPED_TRACE(testing::Message() << run.candidates << " by light, " << run.bsdf << " by BSDF");
    View view(32, 32, frontCamera(5e-4));
    for (uint32_t i = 0; i < 32 * 32; ++i) view.setOnPlane(i % 32, i / 32, 0.0, {0.3, 0.2, 1.0}, run.finish);
    PassTest t("restir_di.Initial");
    show(t, view, scene);
    t.param("candidates", run.candidates).param("bsdfCandidates", run.bsdf).param("visibility", "false").seed(4);
    const double truth = truthOf(view[0], environment.divided(run.finish.roughness < 0.5 ? 16 : 8));
    Sample sample;
    for (int frame = 0; frame < 24; ++frame) {
      t.run();
      const auto out = t.output<Reservoir>("reservoirs");
      for (size_t i = 0; i < out.size(); ++i) {
        ASSERT_TRUE(isFinite(out[i]));
        double value = 0.0;
        if (out[i].weight > 0.0f) {
          const glm::dvec2 uv = environment.place(table, out[i].place).uv;
          value = oracle::luminance(oracle::bsdfCos(view[i], environment.direction(uv.x, uv.y)) *
                                    environment.at(uv.x, uv.y)) *
                  out[i].weight;
        }
        sample.add(value / truth);
      }
    }
    // 24 thousand independent values each; quadrature and the texture filter's steps stay below a part in a thousand.
    EXPECT_NEAR(sample.mean(), 1.0, 4.5 * sample.standardError() + 1e-3);
    EXPECT_LT(sample.standardError(), 0.02);
  }
}

// A reservoir's direction is the same from every surface: reuse changes nothing but f.
TEST(RestirEnvironment, ShadeLooksAlongThePlace) {
  const scene::Scene scene = skyScene(environmentOf(8, 4, spotted));
  const scene::EnvironmentTable table = scene::tabulate(scene.environment);
  const EnvironmentOracle environment(scene.environment);
  const View view = planeView(16, 16, frontCamera());
  PassTest t("restir_di.Shade");
  t.leaveOpen("light");
  show(t, view, scene);
  t.param("visibility", "false");
  std::vector<Reservoir> reservoirs(view.pixels());
  for (size_t i = 0; i < reservoirs.size(); ++i) {
    reservoirs[i].light = 0;
    reservoirs[i].place = hashOf(static_cast<uint32_t>(i) + 5);
    reservoirs[i].weight = 0.5f;
    reservoirs[i].confidence = 1.0f;
  }
  t.input("reservoirs", reservoirs).run();
  const auto color = t.output<glm::vec4>("color");
  int lit = 0;
  for (size_t i = 0; i < color.size(); ++i) {
    const glm::dvec2 uv = environment.place(table, reservoirs[i].place).uv;
    const glm::dvec3 expected =
        0.5 * oracle::bsdfCos(view[i], environment.direction(uv.x, uv.y)) * environment.at(uv.x, uv.y);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(color[i][c], expected[c], 2e-3 * expected[c] + 2e-3);
    lit += expected.x > 0;
  }
  EXPECT_GT(lit, 80);
}

}  // namespace
}  // namespace weir::test
