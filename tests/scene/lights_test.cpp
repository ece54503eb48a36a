// KHR_lights_punctual on import: kinds, defaults, nested transforms.
#include "scene_support.h"

#include <glm/gtc/quaternion.hpp>

namespace weir::scene::test {
namespace {

constexpr float kQuarterPi = 0.78539816f;

json use(int light) {
  return {{"KHR_lights_punctual", {{"light", light}}}};
}

TEST(LightImport, DefaultsAreTheExtensions) {
  GltfText g = GltfText::triangle();
  g.j["extensionsUsed"] = {"KHR_lights_punctual"};
  g.j["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}},
                                                        {{"type", "spot"}, {"spot", json::object()}},
                                                        {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.7}}}},
                                                        {{"type", "spot"}, {"spot", {{"outerConeAngle", 0.3}}}},
                                                        {{"type", "directional"}, {"range", 200}}};
  g.j["nodes"] = {{{"mesh", 0}, {"children", {1, 2, 3, 4, 5}}}};
  for (int i = 0; i < 5; ++i) g.j["nodes"].push_back({{"extensions", use(i)}});
  const Scene s = load(g.text());
  EXPECT_TRUE(s.warnings.empty());
  ASSERT_EQ(s.lights.size(), 5u);
  for (const PunctualLight& light : s.lights) {
    EXPECT_EQ(light.intensity, glm::vec3(1.0f));
    EXPECT_EQ(light.range, 0.0f);  // unbounded; a directional light has none to begin with
    EXPECT_EQ(light.direction, glm::vec3(0, 0, -1));
    EXPECT_EQ(light.position, glm::vec3(0));
  }
  EXPECT_EQ(s.lights[1].innerCone, 0.0f);
  EXPECT_EQ(s.lights[1].outerCone, kQuarterPi);
  EXPECT_EQ(s.lights[2].innerCone, 0.7f);
  EXPECT_EQ(s.lights[2].outerCone, kQuarterPi);
  EXPECT_EQ(s.lights[3].innerCone, 0.0f);
  EXPECT_EQ(s.lights[3].outerCone, 0.3f);
}

TEST(LightImport, ConesOutOfOrderAreClampedWithAWarning) {
  for (const auto& [inner, outer, wantInner, wantOuter] :
       {std::array{0.9, 0.5, 0.5, 0.5}, {-0.1, 0.5, 0.0, 0.5}, {0.1, 2.0, 0.1, 1.57079633}}) {
    GltfText g = GltfText::triangle();
    g.j["extensionsUsed"] = {"KHR_lights_punctual"};
    g.j["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "spot"}, {"spot", {{"innerConeAngle", inner}, {"outerConeAngle", outer}}}}};
    g.j["nodes"][0]["extensions"] = use(0);
    const Scene s = load(g.text());
    EXPECT_EQ(s.warnings.size(), 1u);
    EXPECT_NEAR(s.lights.at(0).innerCone, wantInner, 1e-6);
    EXPECT_NEAR(s.lights.at(0).outerCone, wantOuter, 1e-6);
    for (const GpuLight& light : prepareScene(s).lights) {
      EXPECT_TRUE(std::isfinite(light.b.x) && std::isfinite(light.pdf));
    }
  }
}

// A light's own scale, and that of its parents, moves it but does not dim it.
TEST(LightImport, NestedTurnedMirroredAndStretchedNodes) {
  GltfText g = GltfText::triangle();
  g.j["extensionsUsed"] = {"KHR_lights_punctual"};
  g.j["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "spot"}, {"spot", json::object()}, {"intensity", 5}, {"range", 2}}, {{"type", "directional"}}};
  const double h = std::sqrt(0.5);
  g.j["nodes"] = {{{"children", {1, 4}}, {"translation", {10, 0, 0}}, {"rotation", {0, h, 0, h}}},  // -Z to -X
                  {{"children", {2, 3}}, {"scale", {3, 4, -2}}},                                    // mirrors: -Z to +Z
                  {{"extensions", use(0)}, {"translation", {0, 1, -1}}},
                  {{"extensions", use(1)}},
                  {{"mesh", 0}}};
  const Scene s = load(g.text());
  ASSERT_EQ(s.lights.size(), 2u);
  // (0, 1, -1) → scaled (0, 4, 2) → turned (2, 4, 0) → moved.
  EXPECT_LT(glm::distance(s.lights[0].position, glm::vec3(12, 4, 0)), 1e-5f);
  for (const PunctualLight& light : s.lights) EXPECT_LT(glm::distance(light.direction, glm::vec3(1, 0, 0)), 1e-6f);
  EXPECT_EQ(s.lights[0].intensity, glm::vec3(5));
  EXPECT_EQ(s.lights[0].range, 2.0f);
}

TEST(LightImport, SphereWithPunctualLights) {
  const std::string folder = sceneFolder();
  if (folder.empty()) GTEST_SKIP() << "no scenes";
  const Scene s = importGltf(folder + "/sphere-punctual-lights/sphere-punctual-lights.glb");
  EXPECT_TRUE(s.warnings.empty());
  ASSERT_EQ(s.lights.size(), 4u);
  // All four hang below one node; its rotation is all that turns them.
  const glm::quat q(0.7281938412f, -0.1395907917f, -0.6590063691f, -0.1263279302f);
  const glm::vec3 way = q * glm::vec3(0, 0, -1);
  struct Expected {
    const char* name;
    LightKind kind;
    glm::vec3 intensity;
    float range, inner, outer;
  };
  // In the order of the hierarchy: the node itself, then its children, each before its own.
  const Expected expected[] = {{"Blue Lightsaber", LightKind::Spot, {2.16f, 2.13f, 3.0f}, 100, 0.2f, 0.8f},
                               {"Arc Reactor", LightKind::Directional, {0.9f, 0.9f, 0.9f}, 0, 0, 0},
                               {"", LightKind::Spot, {1, 1, 1}, 0, 0, kQuarterPi},
                               {"The Star of Earendil", LightKind::Point, {4.5f, 4.85f, 5.0f}, 1000, 0, 0}};
  for (int i = 0; i < 4; ++i) {
    SCOPED_TRACE(i);
    const PunctualLight& light = s.lights[i];
    EXPECT_EQ(light.name, expected[i].name);
    EXPECT_EQ(light.kind, expected[i].kind);
    EXPECT_LT(glm::distance(light.intensity, expected[i].intensity), 1e-5f);
    EXPECT_EQ(light.range, expected[i].range);
    EXPECT_EQ(light.position, glm::vec3(0));
    EXPECT_LT(glm::distance(light.direction, way), 1e-5f);
    if (light.kind != LightKind::Spot) continue;
    EXPECT_FLOAT_EQ(light.innerCone, expected[i].inner);
    EXPECT_FLOAT_EQ(light.outerCone, expected[i].outer);
  }
  EXPECT_EQ(prepareScene(s).lights.size(), 4u);
}

}  // namespace
}  // namespace weir::scene::test
