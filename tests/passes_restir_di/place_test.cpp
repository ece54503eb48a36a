// Picks by place of restir_di.Initial: the probabilities that docs/lights.md says, whatever lights there are, and
// refusals of what can't be.
#include <gtest/gtest.h>
#include <weir/core/error.h>
#include <weir/scene/import.h>

#include <cmath>
#include <cstring>

#include "setup.h"
#include "support/environment_oracle.h"
#include "support/light_tree_oracle.h"
#include "support/small_scenes.h"

namespace weir::test {
namespace {

using oracle::Vec;
using passes::Reservoir;

constexpr uint32_t kTile = 16;

float number(uint32_t i, uint32_t what) {
  return static_cast<float>(uniformOf(i * 31 + what * 7919 + 5));
}

/// Lights before the plane z = 0, most of them dim, some close to it.
scene::Scene cloud(uint32_t count, bool mixture, float size = 1.0f, float power = 1.0f) {
  Builder b;
  // Far behind: its sides give the scene its size.
  b.add(quad({-3, -3, -6}, {3, -3, -6}, {3, 3, -6}, {-3, 3, -6}));
  scene::Material lamp;
  lamp.emission = {2.0f, 1.5f, 1.0f};
  const int shining = b.material(lamp);
  for (uint32_t i = 0; i < count; ++i) {
    const glm::vec3 at(4 * number(i, 0) - 2, 4 * number(i, 1) - 2, 0.05f + 3 * number(i, 2) * number(i, 3));
    if (mixture && i % 5 == 4) {  // faces the plane
      const float s = 0.05f + 0.2f * number(i, 4);
      b.add(quad(at, at + glm::vec3(0, s, 0.01f), at + glm::vec3(s, s, 0), at + glm::vec3(s, 0, 0), shining));
      continue;
    }
    scene::PunctualLight light;
    light.position = at;
    light.intensity = glm::vec3(0.2f, 0.3f, 0.1f) * power * (i % 17 == 3 ? 20.0f : 0.1f + number(i, 5));
    if (mixture && i % 5 == 1) {
      light.kind = scene::LightKind::Spot;
      light.direction = {0, 0, -1};
      light.innerCone = 0.5f;
      light.outerCone = 1.5707f;  // so that all of the plane gets some
    }
    if (mixture && i % 5 == 2) light.range = 20.0f;
    b.scene.lights.push_back(light);
  }
  return size == 1.0f ? b.scene : scaled(b.scene, size);
}

void addSun(scene::Scene& scene) {
  scene::PunctualLight sun;
  sun.kind = scene::LightKind::Directional;
  sun.direction = glm::normalize(glm::vec3(0.2f, 0.3f, -1.0f));
  sun.intensity = glm::vec3(0.05f);
  scene.lights.push_back(sun);
}

glm::vec3 plainSky(uint32_t /*x*/, uint32_t /*y*/) {
  return glm::vec3(0.02f);
}

/// Of each tile.
std::vector<TileBoxes> boxesOf(const View& view) {
  const uint32_t across = (view.width() + kTile - 1) / kTile, down = (view.height() + kTile - 1) / kTile;
  std::vector<TileBoxes> boxes(size_t{across} * down);
  for (size_t i = 0; i < view.pixels(); ++i)
    if (view.has(i))
      boxes[i / view.width() / kTile * across + i % view.width() / kTile].add(view[i].position, view[i].geometric);
  return boxes;
}

size_t tileOf(const View& view, size_t pixel) {
  const uint32_t across = (view.width() + kTile - 1) / kTile;
  return pixel / view.width() / kTile * across + pixel % view.width() / kTile;
}

/// A pass that shows what it picked: one candidate, points on triangles by area. W is then the light's area over its
/// probability.
void showPicks(PassTest& t, const View& view, const scene::Scene& scene) {
  show(t, view, scene);
  t.param("picks", "place").param("candidates", "1").param("visibility", "false").param("triangles", "area");
  t.param("lobeShare", "0").param("bsdfCandidates", "0");
}

/// Unlike surfaces, in tiles that are not whole.
View unlikeView(float size = 1.0f) {
  scene::Camera camera = frontCamera();
  camera.eye *= size;
  View view(40, 27, camera);
  for (uint32_t y = 0; y < 27; ++y)
    for (uint32_t x = 0; x < 40; ++x) {
      const double tilt = y < 16 ? 0.0 : 0.02 * x;
      if ((x + y) % 13 != 0) view.setOnPlane(x, y, (x < 16 ? 0.0 : -1.0) * size, Vec(tilt, -0.3 * tilt, 1.0));
    }
  return view;
}

struct Case {
  const char* name;
  scene::Scene scene;
  float size = 1.0f;
};

std::vector<Case> everyCase() {
  std::vector<Case> cases;
  cases.push_back({"one", cloud(1, false)});
  cases.push_back({"points", cloud(300, false)});
  cases.push_back({"mixture", cloud(200, true)});
  cases.push_back({"mixture, a sun", cloud(200, true)});
  addSun(cases.back().scene);
  cases.push_back({"points under a sky", cloud(60, false)});
  cases.back().scene.environment = environmentOf(4, 2, plainSky);
  cases.push_back({"a sun alone", cloud(0, false)});
  addSun(cases.back().scene);
  cases.push_back({"in one place", namedLights(100)});
  cases.push_back({"many", cloud(9000, false)});  // with levels below the cut
  cases.push_back({"many, mixture, a sun", cloud(34000, true)});
  addSun(cases.back().scene);
  cases.push_back({"small", cloud(100, true, 1e-4f), 1e-4f});
  cases.push_back({"large", cloud(100, false, 1e15f), 1e15f});
  cases.push_back({"dim", cloud(100, false, 1.0f, 1e-20f)});
  cases.push_back({"bright", cloud(100, false, 1.0f, 1e20f)});
  cases.push_back({"far away", cloud(50, false)});
  for (uint32_t i = 0; i < 50; ++i) {
    cases.back().scene.lights[i].position.z += 1e4f;
    cases.back().scene.lights[i].intensity *= 1e8f;
  }
  return cases;
}

// To a part in 500, which float against double precision is far from but where a probability is next to nothing.
TEST(RestirPlace, WeighsOneOverTheProbability) {
  for (const Case& c : everyCase()) {
    SCOPED_TRACE(c.name);
    const View view = unlikeView(c.size);
    PassTest t("restir_di.Initial");
    showPicks(t, view, c.scene);
    const scene::PreparedScene& prepared = t.prepared();
    const scene::LightTree tree = scene::buildLightTree(prepared.lights, prepared.bounds);
    std::vector<std::vector<double>> p;
    for (const TileBoxes& boxes : boxesOf(view))
      p.push_back(LightTreeOracle(tree).probabilities(boxes, prepared.lights.size()));
    std::vector<int> seen(prepared.lights.size(), 0);
    const uint32_t sky = prepared.environment.cells.empty() ? scene::kNoLight : static_cast<uint32_t>(seen.size() - 1);
    uint64_t picked = 0, all = 0;
    for (int frame = 0; frame < 8; ++frame) {
      t.run();
      const std::vector<Reservoir> out = t.output<Reservoir>("reservoirs");
      for (size_t i = 0; i < out.size(); ++i) {
        ASSERT_TRUE(isFinite(out[i]));
        all += view.has(i) ? 1 : 0;
        if (!(out[i].weight > 0.0f)) continue;
        const uint32_t light = lightOf(out[i]);
        ASSERT_LT(light, seen.size());
        ++seen[light];
        ++picked;
        if (light == sky) continue;
        const bool lamp = prepared.lights[light].kind == static_cast<uint32_t>(scene::GpuLightKind::Triangle);
        const double area = lamp ? double{prepared.lights[light].area} : 1.0;
        ASSERT_NEAR(out[i].weight / area * p[tileOf(view, i)][light], 1.0, 2e-3) << "light " << light;
      }
    }
    EXPECT_GT(picked, all / 2);
    if (seen.size() < 20) {
      for (const int count : seen) EXPECT_GT(count, 0);
    }
  }
}

/// How often lights came up by themselves, and how often their probabilities say, in `groups` groups of lights whose
/// numbers are alike. Up to `mostUnlit` of them may show nothing, as a tilted lamp does to who stands beside it.
double chanceOfPicks(const scene::Scene& scene, size_t groups, uint32_t frames, uint32_t mostUnlit) {
  constexpr uint32_t kSide = 64;
  const View view = planeView(kSide, kSide, frontCamera());
  PassTest t("restir_di.Initial");
  showPicks(t, view, scene);
  t.seed(23);
  const scene::PreparedScene& prepared = t.prepared();
  const scene::LightTree tree = scene::buildLightTree(prepared.lights, prepared.bounds);
  std::vector<double> expected(groups + 1, 0.0);
  const std::vector<TileBoxes> boxes = boxesOf(view);
  for (const TileBoxes& tile : boxes) {
    const std::vector<double> p = LightTreeOracle(tree).probabilities(tile, prepared.lights.size());
    for (size_t i = 0; i < p.size(); ++i) expected[i % groups] += p[i] / static_cast<double>(boxes.size());
  }
  std::vector<uint64_t> counts(expected.size(), 0);
  uint32_t unlit = 0;
  for (uint32_t frame = 0; frame < frames; ++frame) {
    t.run();
    const std::vector<Reservoir> out = t.output<Reservoir>("reservoirs");
    for (uint32_t tile = 0; tile < boxes.size(); ++tile) {
      const uint32_t at = hashOf(frame * 64 + tile) % (kTile * kTile);
      const uint32_t x = tile % 4 * kTile + at % kTile, y = tile / 4 * kTile + at / kTile;
      const Reservoir& r = out[y * kSide + x];
      if (r.weight > 0.0f)
        ++counts[lightOf(r) % groups];
      else
        ++unlit;
    }
  }
  EXPECT_LE(unlit, mostUnlit);
  return chiSquareP(counts, expected);
}

// One pixel of each tile a frame, so that all picks are independent. Their number is a sum over tiles, whose χ² is if
// anything too small: a false alarm has a chance of at most 1e-4 in each.
TEST(RestirPlace, PicksFollowTheirProbabilities) {
  scene::Scene mixture = cloud(70, true);
  addSun(mixture);
  EXPECT_GT(chanceOfPicks(cloud(70, false), 70, 250, 0), 1e-4);
  EXPECT_GT(chanceOfPicks(mixture, 100, 250, 4), 1e-4);
  // With levels below the cut.
  EXPECT_GT(chanceOfPicks(cloud(9000, false), 100, 250, 0), 1e-4);
}

// Nothing that a tile's surfaces can see is worth anything: no candidates, and no harm.
TEST(RestirPlace, TilesThatNothingLightsStayEmpty) {
  scene::Scene scene = cloud(40, true);
  for (const bool behind : {false, true}) {
    View view(32, 16, frontCamera());
    for (uint32_t y = 0; y < 16; ++y)
      for (uint32_t x = 16; x < 32; ++x)
        if (behind) view.setOnPlane(x, y, 0.0, Vec(0.0, 0.0, -1.0));
    PassTest t("restir_di.Initial");
    showPicks(t, view, scene);
    t.run();
    for (const Reservoir& r : t.output<Reservoir>("reservoirs")) EXPECT_EQ(r.weight, 0.0f);
  }
  PassTest t("restir_di.Initial");
  showPicks(t, planeView(20, 20, frontCamera()), pointScene({}));
  t.run();
  for (const Reservoir& r : t.output<Reservoir>("reservoirs")) EXPECT_EQ(r.weight, 0.0f);
}

std::vector<Reservoir> oneFrame(const char* picks, uint32_t lights) {
  PassTest t("restir_di.Initial");
  show(t, planeView(32, 32, frontCamera()), cloud(lights, false));
  t.param("picks", picks).param("candidates", "4").param("visibility", "false").seed(5).run();
  return t.output<Reservoir>("reservoirs");
}

bool same(const std::vector<Reservoir>& a, const std::vector<Reservoir>& b) {
  return std::memcmp(a.data(), b.data(), a.size() * sizeof(Reservoir)) == 0;
}

TEST(RestirPlace, ManyLightsArePickedByPlaceUnasked) {
  EXPECT_TRUE(same(oneFrame("auto", 1000), oneFrame("place", 1000)));
  EXPECT_FALSE(same(oneFrame("auto", 1000), oneFrame("power", 1000)));
  EXPECT_TRUE(same(oneFrame("auto", 999), oneFrame("power", 999)));
}

/// What the pass says to parameters that don't go together; empty: it runs.
std::string complaint(PassTest& t) {
  try {
    t.run();
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(RestirPlace, RefusesWhatCantBe) {
  const View view = planeView(16, 16, frontCamera());
  const std::pair<const char*, const char*> notTiled[] = {{"tiles", "off"}, {"bsdfRays", "1"}};
  for (const auto& [name, value] : notTiled) {
    for (const char* picks : {"place", "auto"}) {
      SCOPED_TRACE(testing::Message() << name << ' ' << picks);
      PassTest t("restir_di.Initial");
      show(t, view, cloud(5000, false));
      const std::string said = complaint(t.param("picks", picks).param(name, value));
      if (std::string(picks) == "auto") {
        EXPECT_EQ(said, "");
      } else {
        EXPECT_NE(said.find("picks 'place'"), std::string::npos) << said;
        EXPECT_NE(said.find("expected picks 'auto' or 'power'"), std::string::npos) << said;
      }
    }
  }
}

TEST(RestirPlace, RefusesLightsThatMove) {
  for (const char* picks : {"place", "auto"}) {
    PassTest t("restir_di.Initial");
    t.size(16, 16).scene(scene::importGltf(sourcePath("scenes/cornell-moving.glb"))).clip("everything");
    const std::string said = complaint(t.param("picks", picks));
    if (std::string(picks) == "auto") {
      EXPECT_EQ(said, "");
    } else {
      EXPECT_NE(said.find("lights that stay"), std::string::npos) << said;
    }
  }
}

}  // namespace
}  // namespace weir::test
