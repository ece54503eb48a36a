// The light tree: every light in it once, boxes and powers that hold what is below, and probabilities that add up and
// leave no light out that can light a surface.
#include <weir/core/error.h>
#include <weir/scene/light_tree.h>

#include <chrono>
#include <cstring>
#include <iostream>
#include <random>

#include "scene_support.h"
#include "support/light_tree_oracle.h"

namespace weir::scene::test {
namespace {

using weir::test::Box;
using weir::test::LightTreeOracle;
using weir::test::TileBoxes;

struct Many {
  const char* name;
  size_t points = 0, triangles = 0, directional = 0;
  bool environment = false;
  float size = 1.0f;                             ///< of the box that they are in, m
  float offset = 0.0f;                           ///< of the box from the origin
  bool flat = false, dot = false, wild = false;  ///< in a plane; all in one place; powers over 40 decades
};

const Many kEvery[] = {{"none"},
                       {"one point", 1},
                       {"two points", 2},
                       {"nine points", 9},
                       {"points", 1000},
                       {"many points", 9000},
                       {"triangles", 0, 333},
                       {"mixed", 500, 700, 3, true},
                       {"unplaced alone", 0, 0, 5, true},
                       {"the sky alone", 0, 0, 0, true},
                       {"in one place", 300, 0, 0, false, 1.0f, 4.0f, false, true},
                       {"in a plane", 100, 100, 0, false, 1.0f, 0.0f, true},
                       {"powers of all sizes", 400, 100, 2, true, 1.0f, 0.0f, false, false, true},
                       {"many of all kinds", 5000, 5000, 1, true},
                       {"tiny", 300, 300, 0, false, 1e-20f},
                       {"huge", 300, 300, 1, false, 1e20f},
                       {"far away", 300, 300, 0, false, 1.0f, 1e5f}};

std::vector<GpuLight> lightsOf(const Many& many, uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> u(0.0f, 1.0f);
  const auto place = [&] {
    glm::vec3 p(u(random), u(random), u(random));
    if (many.flat) p.y = 0.25f;
    if (many.dot) p = glm::vec3(0.5f);
    return (p + many.offset) * many.size;
  };
  std::vector<GpuLight> lights;
  const auto add = [&](GpuLightKind kind, size_t count) {
    for (size_t i = 0; i < count; ++i) {
      GpuLight light;
      light.kind = static_cast<uint32_t>(kind);
      light.position = place();
      light.pdf = many.wild ? std::pow(10.0f, 40.0f * u(random) - 38.0f) : u(random);
      if (kind == GpuLightKind::Triangle) {
        light.a = (glm::vec3(u(random), u(random), u(random)) - 0.5f) * 0.3f * many.size;
        light.b = (glm::vec3(u(random), u(random), u(random)) - 0.5f) * 0.3f * many.size;
        if (many.flat) light.a.y = light.b.y = 0.0f;
      }
      lights.push_back(light);
    }
  };
  add(GpuLightKind::Triangle, many.triangles);
  add(GpuLightKind::Point, (many.points + 1) / 2);
  add(GpuLightKind::Directional, many.directional);
  add(GpuLightKind::Spot, many.points / 2);
  if (many.environment) add(GpuLightKind::Environment, 1);
  double sum = 0.0;
  for (const GpuLight& light : lights) sum += light.pdf;
  for (GpuLight& light : lights) light.pdf = static_cast<float>(light.pdf / sum);
  return lights;
}

std::vector<glm::dvec3> corners(const GpuLight& light) {
  if (light.kind != static_cast<uint32_t>(GpuLightKind::Triangle)) return {light.position};
  return {light.position, light.position + light.a, light.position + light.b};
}

TEST(LightTree, HoldsEveryLightOnce) {
  for (const Many& many : kEvery) {
    SCOPED_TRACE(many.name);
    const std::vector<GpuLight> lights = lightsOf(many, 3);
    const LightTree tree = buildLightTree(lights, {});
    ASSERT_EQ(tree.entries.size(), lights.size());
    ASSERT_EQ(tree.nodes.size(), size_t{2} << tree.levels);
    std::vector<int> seen(lights.size(), 0);
    for (const TreeEntry& entry : tree.entries) ++seen.at(entry.light);
    for (const int times : seen) ASSERT_EQ(times, 1);
    for (size_t i = 0; i < tree.entries.size(); ++i)
      ASSERT_EQ(hasPlace(lights[tree.entries[i].light]), i < tree.lights.size());
    ASSERT_LE(tree.cutLevels, LightTree::kMostCutLevels);
    ASSERT_EQ((tree.levels - tree.cutLevels) % 2, 0u);
    const size_t leaves = size_t{1} << tree.levels;
    const LightTreeOracle oracle(tree);
    for (size_t leaf = 0; leaf < leaves && !tree.lights.empty(); ++leaf) {
      const uint64_t first = tree.firstOf(leaf), end = tree.firstOf(leaf + 1);
      ASSERT_GT(end, first);
      ASSERT_LE(end - first, LightTree::kMostInLeaf);
      const double slack = 1e-6 * many.size * (1.0 + many.offset);
      double power = 0.0;
      for (uint64_t i = first; i < end; ++i) {
        power += tree.lights[i].power;
        const GpuLight& light = lights[tree.entries[i].light];
        const double radius = std::bit_cast<float>(tree.entries[i].bits);
        for (const glm::dvec3& corner : corners(light)) {
          for (size_t above = leaves + leaf; above > 0; above /= 2)
            ASSERT_TRUE(oracle.boxOf(above).holds(corner, slack));
          ASSERT_LE(glm::length(corner - glm::dvec3(tree.lights[i].centre)), radius + slack);
        }
      }
      ASSERT_NEAR(tree.nodes[leaves + leaf].power, power, 1e-6 * power);
    }
    ASSERT_EQ(tree.firstOf(leaves), tree.lights.size());
    for (size_t node = 1; node < leaves; ++node)
      ASSERT_FLOAT_EQ(tree.nodes[node].power, tree.nodes[2 * node].power + tree.nodes[2 * node + 1].power);
    const LightTree again = buildLightTree(lights, {});
    if (!lights.empty()) {
      EXPECT_EQ(std::memcmp(tree.entries.data(), again.entries.data(), lights.size() * sizeof(TreeEntry)), 0);
    }
  }
}

// Halving along the longest side makes boxes small: of uniform points in a cube, the leaves' boxes together have less
// than the cube's volume, and their longest sides are those of cubes of as many to within a factor of three.
TEST(LightTree, LeavesAreCompact) {
  const std::vector<GpuLight> lights = lightsOf({"", 20000}, 5);
  const LightTree tree = buildLightTree(lights, {});
  double volume = 0.0, sides = 0.0;
  const size_t leaves = size_t{1} << tree.levels;
  for (size_t node = leaves; node < 2 * leaves; ++node) {
    const Box box = LightTreeOracle(tree).boxOf(node);
    const glm::dvec3 side = box.high - box.low;
    volume += side.x * side.y * side.z;
    sides += std::max(side.x, std::max(side.y, side.z));
  }
  EXPECT_LT(volume, 1.0);
  EXPECT_LT(sides / static_cast<double>(leaves), 3.0 * std::cbrt(1.0 / static_cast<double>(leaves)));
}

TEST(LightTree, NumbersOfUnplacedLightsFollowTheirPowers) {
  for (const Many& many : kEvery) {
    SCOPED_TRACE(many.name);
    const std::vector<GpuLight> lights = lightsOf(many, 7);
    const LightTree tree = buildLightTree(lights, {});
    double sum = 0.0, all = 0.0;
    for (const GpuLight& light : lights) {
      all += light.pdf;
      if (!hasPlace(light)) sum += light.pdf;
    }
    double before = -1.0;
    for (size_t i = tree.lights.size(); i < tree.entries.size(); ++i) {
      const double last = tree.entries[i].bits;
      ASSERT_GT(last, before);
      EXPECT_NEAR((last - before) / 4294967296.0, lights[tree.entries[i].light].pdf / sum, 1e-8);
      before = last;
    }
    if (tree.unplaced() == 0) {
      EXPECT_EQ(tree.unplacedShare, 0u);
    } else {
      EXPECT_EQ(before, 4294967295.0);
      const double share = tree.lights.empty() ? 1.0 : std::clamp(sum / all, 0.25, 0.75);
      EXPECT_NEAR(tree.unplacedShare / 16777216.0, share, 1e-6);
    }
  }
}

// Random surfaces, alone and in groups. Together all picks have probability 1, less what ends below a node that seemed
// worth something; and a light that stands above a surface has some.
TEST(LightTree, ProbabilitiesAddUpAndLeaveNoneOut) {
  for (const Many& many : kEvery) {
    SCOPED_TRACE(many.name);
    const std::vector<GpuLight> lights = lightsOf(many, 11);
    const LightTree tree = buildLightTree(lights, {});
    const LightTreeOracle oracle(tree);
    std::mt19937_64 random(13);
    std::uniform_real_distribution<double> u(-0.5, 1.5);
    int whole = 0;
    constexpr int kTiles = 60;
    for (int t = 0; t < kTiles; ++t) {
      TileBoxes tile;
      std::vector<std::pair<glm::dvec3, glm::dvec3>> surfaces;
      const glm::dvec3 place(u(random), u(random), u(random)),
          normal(u(random) - 0.5, u(random) - 0.5, u(random) - 0.5);
      for (int i = 0; i < (t % 3 == 0 ? 1 : 20); ++i) {
        const double wide = t % 3 == 1 ? 0.02 : 0.6;
        const glm::dvec3 p =
            (place + wide * glm::dvec3(u(random), u(random), u(random)) + double{many.offset}) * double{many.size};
        const glm::dvec3 n = glm::normalize(normal + wide * glm::dvec3(u(random), u(random), u(random)));
        surfaces.emplace_back(p, n);
        tile.add(p, n);
      }
      const std::vector<double> p = oracle.probabilities(tile, lights.size());
      double sum = 0.0;
      for (const double x : p) sum += x;
      EXPECT_LE(sum, 1.0 + 1e-9);
      if (sum > 1.0 - 1e-9) ++whole;
      for (size_t i = 0; i < lights.size(); ++i) {
        if (!hasPlace(lights[i])) {
          EXPECT_GT(p[i], 0.0);
          continue;
        }
        for (const auto& [at, n] : surfaces)
          for (const glm::dvec3& corner : corners(lights[i]))
            if (glm::dot(n, corner - at) > 1e-5 * many.size * (1.0 + many.offset)) {
              ASSERT_GT(p[i], 0.0) << i;
            }
      }
    }
    if (!lights.empty()) EXPECT_GT(whole, kTiles / 3);
  }
}

// A light that is near is picked more often than the same light far away, and one of twice the power about twice as
// often.
TEST(LightTree, NearAndBrightLightsAreLikely) {
  std::vector<GpuLight> lights(64);
  for (size_t i = 0; i < lights.size(); ++i) {
    lights[i].position = {static_cast<float>(i % 8), static_cast<float>(i / 8), 1.0f};
    lights[i].pdf = (i == 63 ? 2.0f : 1.0f) / 65.0f;
  }
  const LightTree tree = buildLightTree(lights, {});
  TileBoxes tile;
  tile.add({0.0, 0.0, 0.0}, {0.0, 0.0, 1.0});
  const std::vector<double> p = LightTreeOracle(tree).probabilities(tile, lights.size());
  EXPECT_EQ(std::max_element(p.begin(), p.end()) - p.begin(), 0);
  // cos / d² is 1 for the nearest, and 1 / 99^1.5 for the farthest but one.
  EXPECT_GT(p[0] / p[62], 100.0);
  EXPECT_NEAR(p[63] / p[62], 2.0 * std::pow(87.0 / 99.0, 1.5), 0.8);
}

TEST(LightTree, RefusesPlacesThatAreNotFinite) {
  std::vector<GpuLight> lights(3);
  lights[1].position.y = std::numeric_limits<float>::infinity();
  try {
    buildLightTree(lights, {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("light 1 "), std::string::npos) << error.what();
  }
}

// Two million lights: tens of megabytes, and about a second; the bound leaves room for sanitizers and busy machines.
TEST(LightTree, TwoMillionLights) {
  const std::vector<GpuLight> lights = lightsOf({"", 2'000'000}, 17);
  const auto start = std::chrono::steady_clock::now();
  const LightTree tree = buildLightTree(lights, {});
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const size_t bytes = tree.nodes.size() * sizeof(LightNode) + tree.lights.size() * sizeof(PlacedLight) +
                       tree.entries.size() * sizeof(TreeEntry);
  std::cout << "built in " << seconds << " s, " << (bytes >> 20) << " MiB\n";
  RecordProperty("seconds", std::to_string(seconds));
  EXPECT_EQ(tree.levels, 18u);
  EXPECT_LT(bytes, size_t{80} << 20);
  EXPECT_LT(seconds, 30.0);
}

}  // namespace
}  // namespace weir::scene::test
