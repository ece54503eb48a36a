// Which light a triangle is, and how much of a lamp with alpha shines.
#include "scene_support.h"

#include <weir/scene/emission_map.h>
#include <weir/scene/scene_state.h>

#include <cmath>

#include "support/small_scenes.h"

namespace weir::scene::test {
namespace {

using weir::test::Builder;
using weir::test::quad;

/// The light of any triangle, by the table as shaders read it.
uint32_t lightOf(const PreparedScene& p, uint32_t triangle) {
  const uint32_t entry = triangle - p.firstLitTriangle;
  return entry < p.lightOfTriangle.size() ? p.lightOfTriangle[entry] : kNoLight;
}

void expectTable(const PreparedScene& p) {
  std::vector<uint32_t> expected(p.triangles.size(), kNoLight);
  for (uint32_t i = 0; i < p.triangleLights; ++i) expected[p.lights[i].triangle] = i;
  for (uint32_t t = 0; t < p.triangles.size(); ++t) EXPECT_EQ(lightOf(p, t), expected[t]) << "triangle " << t;
  EXPECT_EQ(lightOf(p, 0xffffffffu), kNoLight);
  ASSERT_EQ(p.lightOfTriangle.empty(), p.triangleLights == 0);
  EXPECT_EQ(p.traits.triangleLights, p.triangleLights > 0);
  if (p.lightOfTriangle.empty()) return;
  EXPECT_NE(p.lightOfTriangle.front(), kNoLight) << "no longer than it has to be";
  EXPECT_NE(p.lightOfTriangle.back(), kNoLight);
}

/// Quads side by side along x, quad i of the i-th material.
Scene row(const std::vector<Material>& materials) {
  Builder b;
  for (size_t i = 0; i < materials.size(); ++i) {
    const float x = static_cast<float>(i);
    b.add(quad({x, 0, 0}, {x + 0.9f, 0, 0}, {x + 0.9f, 1, 0}, {x, 1, 0}, b.material(materials[i])));
  }
  return b.scene;
}

Material lamp(float emission = 1.0f) {
  Material m;
  m.emission = glm::vec3(emission);
  return m;
}

TEST(LightOfTriangle, LeadsBackFromEveryLightAndFromNothingElse) {
  Material doubleSided = lamp(2), masked = lamp(3), unlit = lamp(4);
  doubleSided.doubleSided = true;
  masked.alphaMode = AlphaMode::Mask;
  unlit.model = MaterialModel::Unlit;
  const PreparedScene p = prepareScene(row({{}, lamp(), {}, doubleSided, masked, unlit, {}, lamp(5), {}}));
  EXPECT_EQ(p.triangleLights, 8u);
  expectTable(p);
}

TEST(LightOfTriangle, ScenesWithoutEmissionHaveNone) {
  const PreparedScene p = prepareScene(row({{}, {}}));
  EXPECT_TRUE(p.lightOfTriangle.empty());
  expectTable(p);
  EXPECT_EQ(traitDefines(p.traits).find("TRIANGLE_LIGHTS"), std::string::npos);
}

// A scene of points compiles no other lights: a trait that fails to say so would leave theirs dark.
TEST(LightTraits, SayWhatIsNoPlainPoint) {
  const auto shaped = [](const PunctualLight& light) {
    Scene scene = row({lamp()});
    scene.lights = {{}, light};
    scene.lights[0].intensity = glm::vec3(1.0f);
    return prepareScene(scene).traits.shapedLights;
  };
  PunctualLight light;
  light.intensity = glm::vec3(1.0f);
  EXPECT_FALSE(shaped(light)) << "nor is a lamp beside them";
  light.range = 2.0f;
  EXPECT_TRUE(shaped(light));
  light.range = 0.0f;
  light.kind = LightKind::Spot;
  EXPECT_TRUE(shaped(light));
  light.kind = LightKind::Directional;
  EXPECT_TRUE(shaped(light));
  light.intensity = glm::vec3(0.0f);
  EXPECT_FALSE(shaped(light)) << "a dark one is none";
}

// While a clip plays, a light keeps its triangle, so that one table serves every frame.
TEST(LightOfTriangle, HoldsForEveryMomentOfAClip) {
  const Scene scene = importGltf(WEIR_SOURCE_DIR "/scenes/cornell-moving.glb");
  const Clip& clip = chooseClip(scene, "lamp");
  const PreparedScene p = prepareScene(scene, {}, &clip);
  EXPECT_FALSE(p.movingLights.empty());
  expectTable(p);
  const StateMaker states(scene, p);
  for (const double t : {0.0, 0.7, 1.5}) {
    const SceneState state = states.at(evaluate(scene, clip, t));
    for (uint32_t i = 0; i < p.triangleLights; ++i) EXPECT_EQ(lightOf(p, state.lights[i].triangle), i);
  }
}

/// The lights of one lamp with alpha beside an opaque one of the same size, and the power of a triangle of the former
/// in units of one of the latter.
struct Compared {
  std::vector<GpuLight> lights;
  double power = 0.0;
  bool alphaTrait = false;
};
Compared compare(const Material& m, Builder b = {}, const std::vector<glm::vec4>& colors = {}) {
  b.add(quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, b.material(lamp())));
  Primitive p = quad({2, 0, 0}, {3, 0, 0}, {3, 1, 0}, {2, 1, 0}, b.material(m));
  p.colors = colors;
  b.add(p);
  const PreparedScene prepared = prepareScene(b.scene);
  Compared c;
  c.alphaTrait = prepared.traits.alphaLights;
  float opaque = 0.0f;
  for (const GpuLight& light : prepared.lights) {
    if (prepared.triangles[light.triangle].material == b.scene.materials.size() - 1)
      c.lights.push_back(light);
    else
      opaque = light.pdf;
  }
  for (const GpuLight& light : c.lights) c.power += light.pdf / opaque / 2.0;
  return c;
}

TEST(LightCoverage, TheSameAllOverIsPartOfTheRadiance) {
  Material m = lamp();
  m.alphaMode = AlphaMode::Blend;
  m.baseColor.a = 0.25f;
  const Compared c = compare(m);
  ASSERT_EQ(c.lights.size(), 2u);
  for (const GpuLight& light : c.lights) {
    EXPECT_EQ(light.radiance, glm::vec3(0.25f));
    EXPECT_EQ(light.kind & kLightAlpha, 0u);
  }
  EXPECT_NEAR(c.power, 0.25, 1e-6);
  EXPECT_FALSE(c.alphaTrait) << "nothing varies, shaders need not look";

  // All of its vertices alike are no different.
  const Compared colored = compare(m, {}, std::vector<glm::vec4>(4, {1, 1, 1, 0.4f}));
  ASSERT_EQ(colored.lights.size(), 2u);
  EXPECT_NEAR(colored.lights[0].radiance.x, 0.1, 1e-5);
  EXPECT_FALSE(colored.alphaTrait);

  m.alphaMode = AlphaMode::Opaque;
  EXPECT_EQ(compare(m).lights.at(0).radiance, glm::vec3(1)) << "alpha of what is opaque means nothing";
}

TEST(LightCoverage, MasksAreAllOrNothing) {
  Material m = lamp();
  m.alphaMode = AlphaMode::Mask;
  m.alphaCutoff = 0.5f;
  m.baseColor.a = 0.5f;
  EXPECT_NEAR(compare(m).power, 1.0, 1e-6);
  m.baseColor.a = 0.49f;
  EXPECT_TRUE(compare(m).lights.empty());
  m.alphaMode = AlphaMode::Blend;
  m.baseColor.a = 0.0f;
  EXPECT_TRUE(compare(m).lights.empty());
}

TEST(LightCoverage, VariesWithVertices) {
  Material m = lamp();
  m.alphaMode = AlphaMode::Blend;
  m.baseColor.a = 0.5f;
  const std::vector<glm::vec4> colors = {{1, 1, 1, 0}, {1, 1, 1, 1}, {1, 1, 1, 1}, {1, 1, 1, 0}};
  const Compared blend = compare(m, {}, colors);
  ASSERT_EQ(blend.lights.size(), 2u);
  for (const GpuLight& light : blend.lights) {
    EXPECT_NE(light.kind & kLightAlpha, 0u);
    EXPECT_EQ(light.radiance, glm::vec3(1)) << "what varies is looked up";
  }
  EXPECT_NEAR(blend.power, 0.25, 1e-4);
  EXPECT_TRUE(blend.alphaTrait);
  // One corner of either triangle comes up to the cutoff, or none does.
  m.alphaMode = AlphaMode::Mask;
  m.alphaCutoff = 0.4f;
  EXPECT_GT(compare(m, {}, colors).power, 0.0);
  m.alphaCutoff = 0.6f;
  EXPECT_TRUE(compare(m, {}, colors).lights.empty());
}

TEST(LightCoverage, VariesWithTheTexture) {
  // A quarter of the texels covers by 204/255, the rest not at all.
  Builder b;
  const int texture =
      b.texture(64, 64, [](uint32_t x, uint32_t y) { return glm::u8vec4(255, 255, 255, x < 32 && y < 32 ? 204 : 0); });
  Material m = lamp();
  m.baseColorTexture.texture = texture;
  m.alphaMode = AlphaMode::Blend;
  const Compared blend = compare(m, b);
  ASSERT_EQ(blend.lights.size(), 2u);
  EXPECT_TRUE(blend.alphaTrait);
  EXPECT_NEAR(blend.power, 0.2, 1e-5);
  m.alphaMode = AlphaMode::Mask;
  EXPECT_NEAR(compare(m, b).power, 0.25, 1e-5);
  m.alphaCutoff = 0.9f;
  EXPECT_TRUE(compare(m, b).lights.empty());
  m.alphaCutoff = 0.0f;
  EXPECT_NEAR(compare(m, b).power, 1.0, 1e-5) << "0 comes up to a cutoff of 0";
  // Where its own emission is black it doesn't shine however much is there.
  m.alphaMode = AlphaMode::Blend;
  m.emissiveTexture.texture = b.texture(4, 4, [](uint32_t, uint32_t) { return glm::u8vec4(0, 0, 0, 255); });
  EXPECT_TRUE(compare(m, b).lights.empty());
}

// Every place that covers anything lies on a light, whatever factor, cutoff and wrapping.
TEST(LightCoverage, NoCoveredPlaceIsWithoutALight) {
  const Image image = [] {
    Builder b;
    b.texture(32, 32, [](uint32_t x, uint32_t y) {
      const uint32_t h = weir::test::hashOf(x + 32 * y);
      return glm::u8vec4(255, 255, 255, h % 16 == 0 ? 40 + h / 16 % 216 : 0);
    });
    return b.scene.images[0];
  }();
  for (const std::optional<float> cutoff : {std::optional<float>(), std::optional(0.3f), std::optional(0.7f)}) {
    for (const float factor : {1.0f, 0.75f}) {
      const CoverageMap map(image, Wrap::Repeat, Wrap::MirroredRepeat, factor, cutoff);
      size_t covered = 0, bare = 0;
      for (uint32_t i = 0; i < 4000; ++i) {
        const auto at = [&](uint32_t k) { return static_cast<float>(8.0 * weir::test::uniformOf(16 * i + k) - 4.0); };
        const glm::vec2 a(at(0), at(1)), size(at(2) / 60, at(3) / 60);
        bool any = false;  // of the texels that lie in the box themselves
        const glm::vec2 low = glm::min(a, a + size) * 32.0f, high = glm::max(a, a + size) * 32.0f;
        for (int y = static_cast<int>(std::floor(low.y)); y <= static_cast<int>(std::floor(high.y)); ++y)
          for (int x = static_cast<int>(std::floor(low.x)); x <= static_cast<int>(std::floor(high.x)); ++x) {
            const int u = ((x % 32) + 32) % 32, m = ((y % 64) + 64) % 64, v = m < 32 ? m : 63 - m;
            const float alpha = factor * image.rgba[4 * (32 * v + u) + 3] / 255.0f;
            any |= cutoff ? alpha >= *cutoff : alpha > 0.0f;
          }
        const double mean = map.mean(a, a + glm::vec2(size.x, 0), a + size);
        EXPECT_LE(mean, 1.0);
        if (any) {
          EXPECT_GT(mean, 0.0) << i;
        }
        ++(any ? covered : bare);
      }
      EXPECT_GT(covered, 100u);
      EXPECT_GT(bare, 100u);
    }
  }
}

}  // namespace
}  // namespace weir::scene::test
