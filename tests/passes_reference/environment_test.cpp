// Light from all around: reference.AllLights against closed forms and quadrature in double precision, and the
// background of both G-buffers.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "../../passes/common/layouts.h"
#include "support/environment_oracle.h"
#include "support/pass_test.h"
#include "support/ray_oracle.h"
#include "support/small_scenes.h"

namespace weir::test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr uint32_t kSide = 16;

/// glTF 2.0, appendix B, times the cosine.
glm::dvec3 bsdfCos(const OracleSurface& s, const glm::dvec3& view, const glm::dvec3& light) {
  const double nl = glm::dot(s.normal, light), nv = glm::dot(s.normal, view);
  if (nl <= 0 || glm::dot(s.geometricNormal, light) <= 0) return glm::dvec3(0);
  const glm::dvec3 h = glm::normalize(light + view);
  const double nh = glm::dot(s.normal, h), vh = glm::dot(view, h), a = std::max(s.roughness * s.roughness, 1.0 / 2048);
  const double d = a * a / (kPi * std::pow(nh * nh * (a * a - 1) + 1, 2));
  const double v =
      0.5 / (nl * std::sqrt(nv * nv * (1 - a * a) + a * a) + nv * std::sqrt(nl * nl * (1 - a * a) + a * a));
  const glm::dvec3 f = s.f0 + (1.0 - s.f0) * std::pow(1 - vh, 5);
  return ((1.0 - f) * s.diffuse / kPi + f * d * v) * nl;
}

scene::Material finish(const glm::vec3& color, float metallic, float roughness) {
  scene::Material m;
  m.baseColor = glm::vec4(color, 1);
  m.metallic = metallic;
  m.roughness = roughness;
  m.doubleSided = true;
  return m;
}

Builder floorOf(const scene::Material& material) {
  Builder b;
  b.add(quad({-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}, b.material(material)));
  return b;
}

const scene::Camera kAbove = lookAt({0.3f, 2, 1.5f}, {0, 0, 0}, 40);

struct Means {
  std::vector<glm::dvec3> color;
  std::vector<passes::PackedSurface> surface;
};

Means render(const scene::Scene& scene, const scene::Camera& camera, int samples, uint32_t frames,
             const char* environment = "importance") {
  PassTest eye("gbuffer.RayTraced");
  eye.size(kSide, kSide).scene(scene).camera(camera).run();
  Means m;
  m.surface = eye.output<passes::PackedSurface>("surface");
  PassTest t("reference.AllLights");
  t.size(kSide, kSide).scene(scene).camera(camera);
  t.param("samples", std::to_string(samples)).param("environment", environment);
  t.input("surface", m.surface).input("emission", eye.output<glm::vec4>("emission"));
  m.color.assign(size_t{kSide} * kSide, glm::dvec3(0));
  for (uint32_t f = 0; f < frames; ++f) {
    t.run();
    const auto color = t.output<glm::vec4>("color");
    for (size_t i = 0; i < color.size(); ++i) m.color[i] += glm::dvec3(color[i]) / double(frames);
  }
  return m;
}

using Lights = std::vector<EnvironmentOracle::Small>;

glm::dvec3 sumOf(const Lights& lights, const std::function<glm::dvec3(const glm::dvec3&)>& f) {
  glm::dvec3 sum(0);
  for (const EnvironmentOracle::Small& light : lights) sum += f(light.direction) * light.lux;
  return sum;
}

/// The mean over every `stride`-th surface against that of `expected(surface, view)`, relative to it, by colour.
template <typename Expected>
void expectMean(const scene::Scene& scene, const scene::Camera& camera, const Means& m, uint32_t stride,
                double tolerance, Expected&& expected) {
  const scene::PreparedScene prepared = scene::prepareScene(scene);
  const RayOracle rays(scene, prepared);
  glm::dvec3 sum(0), truth(0);
  int n = 0;
  for (uint32_t i = 0; i < kSide * kSide; ++i) {
    const glm::dvec3 d = oracleDirection(camera, glm::dvec2(i % kSide, i / kSide) + 0.5, kSide, kSide);
    const OracleHit hit = rays.closest(camera.eye, d, true);
    if (!hit || m.surface[i].distance == 0) continue;
    if (i % stride != 0) continue;
    ++n;
    sum += m.color[i];
    truth += expected(rays.surface(hit, d), -d);
  }
  ASSERT_GT(n, 15);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c] / truth[c], 1.0, tolerance) << c;
}

glm::vec3 gradient(uint32_t x, uint32_t y) {
  return {0.2f + 0.05f * float(x), 1.0f + std::cos(0.4f * float(x)), 2.0f + std::sin(0.7f * float(y))};
}

// A white rough floor under a sky of radiance L everywhere: L, less what the model does not return.
TEST(EnvironmentLight, ConstantSkyOverAnOpenPlane) {
  Builder b = floorOf(finish({1, 1, 1}, 0, 1));
  const glm::vec3 sky(0.5f, 1, 2);
  for (const auto& [width, height] : {std::pair{1u, 1u}, {2u, 1u}, {64u, 32u}}) {
    b.scene.environment = environmentOf(width, height, [&](uint32_t, uint32_t) { return sky; });
    const Means m = render(b.scene, kAbove, 8, 3);
    const Lights lights = EnvironmentOracle(b.scene.environment).divided(128 / int(std::max(width, 2u)));
    // 256 pixels of 192 pairs of directions, each within 60 % of the mean: 0.3 %, and colours are packed in 11 bits.
    expectMean(b.scene, kAbove, m, 1, 0.012, [&](const OracleSurface& s, const glm::dvec3& view) {
      return sumOf(lights, [&](const glm::dvec3& l) { return bsdfCos(s, view, l); });
    });
    for (size_t i = 0; i < m.color.size(); ++i) {
      if (m.surface[i].distance == 0) continue;
      EXPECT_NEAR(m.color[i].y, 1.0, 0.25) << "albedo · L, to within noise and what Fresnel takes";
      EXPECT_NEAR(m.color[i].z / m.color[i].x, 4.0, 1e-3);
    }
  }
}

// A wall as high and wide as a mountain along one side takes half of the sky from a Lambertian plane.
TEST(EnvironmentLight, AWallHidesWhatIsBehindIt) {
  Builder b = floorOf(finish({1, 1, 1}, 0, 1));
  b.add(quad({-2, -900, -900}, {-2, -900, 900}, {-2, 900, 900}, {-2, 900, -900}, b.material(finish({0, 0, 0}, 1, 1))));
  b.scene.environment = environmentOf(32, 16, gradient);
  const Lights lights = EnvironmentOracle(b.scene.environment).divided(4);
  expectMean(b.scene, kAbove, render(b.scene, kAbove, 8, 3), 1, 0.015,
             [&](const OracleSurface& s, const glm::dvec3& view) {
               return sumOf(lights, [&](const glm::dvec3& l) {
                 return l.x < 0 && s.position.x > -1.99 ? glm::dvec3(0) : bsdfCos(s, view, l);
               });
             });
}

// One bright texel is a directional light from there: E = ∫ L dω.
TEST(EnvironmentLight, ABrightTexelIsADirectionalLight) {
  constexpr uint32_t kWidth = 512, kHeight = 256, kX = 290, kY = 60;
  for (const float rotation : {0.0f, 0.9f}) {
    Builder b = floorOf(finish({0.8f, 0.6f, 0.4f}, 0, 0.8f));
    // A block of 0.3, for its shadow.
    b.add(quad({-0.3f, 0.3f, 0.3f}, {0.3f, 0.3f, 0.3f}, {0.3f, 0.3f, -0.3f}, {-0.3f, 0.3f, -0.3f},
               b.material(finish({0.5f, 0.5f, 0.5f}, 0, 1))));
    Builder sun = b;
    b.scene.environment = environmentOf(
        kWidth, kHeight,
        [&](uint32_t x, uint32_t y) { return x == kX && y == kY ? glm::vec3(3e4f, 2e4f, 1e4f) : glm::vec3(0); }, 1.0f,
        rotation);
    const EnvironmentOracle oracle(b.scene.environment);
    const glm::dvec3 lux = sumOf(oracle.divided(4), [](const glm::dvec3&) { return glm::dvec3(1); });
    const glm::dvec3 towards = oracle.direction((kX + 0.5) / kWidth, (kY + 0.5) / kHeight);
    // The convention: the middle shows -Z, to the right of it lies +X, rotation is counter-clockwise from above.
    const double longitude = 2 * kPi * ((kX + 0.5) / kWidth - 0.5) - rotation,
                 height = kPi * (0.5 - (kY + 0.5) / kHeight);
    EXPECT_NEAR(towards.x, std::sin(longitude) * std::cos(height), 1e-9);
    EXPECT_NEAR(towards.y, std::sin(height), 1e-9);
    EXPECT_NEAR(towards.z, -std::cos(longitude) * std::cos(height), 1e-9);
    sun.scene.lights.push_back({"", scene::LightKind::Directional, glm::vec3(lux), {}, -glm::vec3(towards)});
    const Means bright = render(b.scene, kAbove, 4, 4), expected = render(sun.scene, kAbove, 1, 1);
    size_t lit = 0, dark = 0, edge = 0;
    double ratio = 0;
    for (size_t i = 0; i < bright.color.size(); ++i) {
      if (bright.surface[i].distance == 0) continue;
      const double e = expected.color[i].x, got = bright.color[i].x;
      if (e > 0 && got > 0.4 * e) {
        ++lit;
        ratio += got / e;
      } else if (e == 0 && got == 0) {
        ++dark;
      } else {
        ++edge;  // penumbra of a disc of a degree
      }
    }
    // A texel's tent under a density that is constant over texels leaves 100 % a sample: 13 % after 64 of them.
    EXPECT_NEAR(ratio / double(lit), 1.0, 0.03);
    EXPECT_GT(lit, 100u);
    EXPECT_GT(dark, 5u);
    EXPECT_LT(edge, 15u);
  }
}

// A gradient over metals and dielectrics, glossy and rough, against quadrature; uniform directions, which share nothing
// with the table, where they suffice.
TEST(EnvironmentLight, GradientAgainstQuadrature) {
  for (const auto& [metallic, roughness] : {std::pair{0.0f, 1.0f}, {0.0f, 0.35f}, {1.0f, 0.3f}, {1.0f, 0.15f}}) {
    SCOPED_TRACE(testing::Message() << "metallic " << metallic << ", roughness " << roughness);
    Builder b = floorOf(finish({0.9f, 0.6f, 0.3f}, metallic, roughness));
    b.scene.environment = environmentOf(24, 12, gradient, 1.0f, -0.5f);
    const Lights lights = EnvironmentOracle(b.scene.environment).divided(roughness < 0.2f ? 16 : 6);
    const auto expected = [&](const OracleSurface& s, const glm::dvec3& view) {
      return sumOf(lights, [&](const glm::dvec3& l) { return bsdfCos(s, view, l); });
    };
    // Colours are packed in 10 or 11 bits.
    expectMean(b.scene, kAbove, render(b.scene, kAbove, 8, 4), 7, 0.015, expected);
    if (metallic > 0) continue;
    expectMean(b.scene, kAbove, render(b.scene, kAbove, 16, 4, "uniform"), 7, 0.015, expected);
  }
}

// As the only light, and as one of several, it adds to the others.
TEST(EnvironmentLight, AddsToTheOthers) {
  Builder b = floorOf(finish({0.7f, 0.7f, 0.7f}, 0, 1)), both = b;
  const scene::PunctualLight point{"", scene::LightKind::Point, {3, 2, 1}, {0.4f, 1.2f, -0.3f}};
  b.scene.lights.push_back(point);
  both.scene.lights.push_back(point);
  both.scene.environment = environmentOf(8, 4, [](uint32_t, uint32_t) { return glm::vec3(0.25f); });
  const Means alone = render(b.scene, kAbove, 1, 1), sum = render(both.scene, kAbove, 8, 2);
  for (size_t i = 0; i < sum.color.size(); ++i) {
    if (sum.surface[i].distance == 0) continue;
    EXPECT_NEAR(sum.color[i].x - alone.color[i].x, 0.7 * 0.25, 0.03);
  }
}

// Where nothing is hit both G-buffers show the environment, and the same of it.
TEST(EnvironmentLight, IsTheBackgroundOfBothGBuffers) {
  Builder b = floorOf(finish({1, 1, 1}, 0, 1));
  b.scene.environment = environmentOf(16, 8, gradient, 1.0f, 0.3f);
  const EnvironmentOracle oracle(b.scene.environment);
  constexpr uint32_t kWide = 48;
  // Straight up, straight down from below the floor, and across the seam behind.
  for (const scene::Camera& camera : {lookAt({0, 1, 0}, {0, 3, 0}, 120), lookAt({0, -1, 0}, {0, -3, 0}, 120),
                                      lookAt({0, 1, 0}, {0.1f, 1.2f, 5}, 100)}) {
    std::vector<glm::vec4> seen[2];
    for (const bool raster : {false, true}) {
      PassTest t(raster ? "gbuffer.Raster" : "gbuffer.RayTraced");
      t.size(kWide, kWide).scene(b.scene).camera(camera).run();
      seen[raster ? 1 : 0] = t.output<glm::vec4>("emission");
    }
    size_t sky = 0;
    for (uint32_t i = 0; i < kWide * kWide; ++i) {
      if (seen[0][i].a != 0 || seen[1][i].a != 0) continue;
      ++sky;
      EXPECT_EQ(seen[0][i], seen[1][i]);
      const glm::dvec3 d = oracleDirection(camera, glm::dvec2(i % kWide, i / kWide) + 0.5, kWide, kWide);
      const glm::dvec3 expected = oracle.radiance(d);
      // Texture filters may weigh in steps of 1/256 of the texels' difference.
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[0][i][c], expected[c], 0.012) << i % kWide << ", " << i / kWide;
    }
    EXPECT_GT(sky, 1000u);
  }
}

// A scene of nothing but its environment: no light of the table, and a background all the same.
TEST(EnvironmentLight, ShowsWhereThereIsNothingElse) {
  scene::Scene empty;
  empty.environment = environmentOf(4, 2, [](uint32_t, uint32_t) { return glm::vec3(1, 2, 3); });
  for (const glm::dvec3& c : render(empty, kAbove, 1, 1).color)
    EXPECT_NEAR(glm::distance(c, glm::dvec3(1, 2, 3)), 0, 1e-3);
}

TEST(EnvironmentLight, BlackIsAsIfThereWereNone) {
  Builder b = floorOf(finish({0.7f, 0.7f, 0.7f}, 0, 1));
  b.scene.environment = environmentOf(4, 2, [](uint32_t, uint32_t) { return glm::vec3(0); });
  for (const glm::dvec3& c : render(b.scene, kAbove, 1, 1).color) EXPECT_EQ(c, glm::dvec3(0));
}

}  // namespace
}  // namespace weir::test
