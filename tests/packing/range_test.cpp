// Radiance from 1e-6 to 1e6 nit through everything that carries it: lights, reservoirs, environments, pictures and
// files.
#include <gtest/gtest.h>
#include <weir/image/image.h>
#include <weir/scene/environment.h>
#include <weir/scene/prepared.h>

#include <cmath>
#include <numbers>

#include "support/environment_oracle.h"
#include "support/ray_oracle.h"
#include "support/restarts.h"
#include "support/small_scenes.h"

namespace weir::test {
namespace {

constexpr uint32_t kSide = 16;
constexpr double kEnergy = 1e-3;

/// Colours of no round numbers, 1 : 0.3 : 0.07.
const glm::vec3 kColour(0.9173f, 0.2871f, 0.0719f);
const glm::vec3 kAlbedo(0.771f, 0.413f, 0.217f);

std::vector<float> decades() {
  std::vector<float> all;
  for (int d = -6; d <= 6; d += 2) all.push_back(std::pow(10.0f, static_cast<float>(d)));
  return all;
}

/// A Lambert floor under a point light of this strength.
scene::Scene litBy(float strength) {
  Builder b;
  scene::Material floor;
  floor.baseColor = glm::vec4(kAlbedo, 1);
  floor.metallic = 0;
  floor.specular = 0;
  b.add(quad({-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}, b.material(floor)));
  b.scene.lights.push_back({"", scene::LightKind::Point, kColour * strength, {0.3f, 1, -0.2f}});
  return b.scene;
}

/// Mean colour of a picture after the way through an EXR file.
glm::dvec3 meanThroughFile(const image::Picture& picture, const TemporaryFolder& folder) {
  const std::string file = folder.path() + "/radiance.exr";
  image::writeExr(file, picture);
  const image::Picture p = image::readExr(file);
  glm::dvec3 sum(0);
  for (size_t i = 0; i < p.rgba.size(); i += 4) sum += glm::dvec3(p.rgba[i], p.rgba[i + 1], p.rgba[i + 2]);
  return sum / (static_cast<double>(p.rgba.size()) / 4);
}

// A point light's floor has no variance but that of rounding albedo, 1e-3 of a value over 256 pixels × 4 frames: 3e-5.
// What it shows is ρ/π I cosθ/d² at every strength.
TEST(Range, FromLightsThroughReservoirsToAFile) {
  const scene::Camera camera = lookAt({0.2f, 1.4f, 1.1f}, {0, 0, 0}, 40);
  const TemporaryFolder folder;
  Workshop workshop;
  glm::dvec3 form(0);
  for (uint32_t i = 0; i < kSide * kSide; ++i) {
    const glm::dvec3 d = oracleDirection(camera, glm::dvec2(i % kSide, i / kSide) + 0.5, kSide, kSide);
    const glm::dvec3 eye(camera.eye), p = eye - d * (eye.y / d.y), to = glm::dvec3(0.3f, 1, -0.2f) - p;
    ASSERT_LT(std::max(std::abs(p.x), std::abs(p.z)), 2);
    form += glm::dvec3(kAlbedo) / std::numbers::pi * glm::dvec3(kColour) * to.y / std::pow(glm::length(to), 3);
  }
  form /= kSide * kSide;
  double worst = 0;
  for (const float strength : decades()) {
    SCOPED_TRACE(strength);
    Setting setting(workshop, litBy(strength), camera);
    setting.run({"graphs/restir_di.json", {}, 1, 4, 3, kSide}, [&](const image::Picture& p) {
      const glm::dvec3 mean = meanThroughFile(p, folder);
      for (int c = 0; c < 3; ++c) {
        const double off = mean[c] / (form[c] * double(strength)) - 1;
        worst = std::max(worst, std::abs(off));
        EXPECT_LT(std::abs(off), kEnergy) << "channel " << c;
      }
    });
  }
  std::cout << "largest relative error over 1e-6 ... 1e6 nit: " << worst << '\n';
}

// What emits in the camera's sight, and environments as backgrounds: as stored, to the last bit of a float and of a
// half.
TEST(Range, OfWhatIsSeenDirectly) {
  const scene::Camera camera = lookAt({0, 0, 1}, {0, 0, 0}, 40);
  const TemporaryFolder folder;
  Workshop workshop;
  double emission = 0, sky = 0;
  for (const float strength : decades()) {
    SCOPED_TRACE(strength);
    Builder lamp;
    scene::Material m;
    m.emission = kColour * strength;
    lamp.add(quad({-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}, lamp.material(m)));
    Builder open;
    open.scene.environment = environmentOf(16, 8, [&](uint32_t, uint32_t) { return kColour * strength; });
    for (const auto& [scene, worst] : {std::pair(&lamp.scene, &emission), {&open.scene, &sky}}) {
      Setting setting(workshop, *scene, camera);
      setting.run({"graphs/all_lights.json", {"direct.samples=1"}, 1, 1, 3, kSide},
                  [&, w = worst](const image::Picture& p) {
                    const glm::dvec3 mean = meanThroughFile(p, folder);
                    for (int c = 0; c < 3; ++c)
                      *w = std::max(*w, std::abs(mean[c] / (double(kColour[c]) * double(strength)) - 1));
                  });
    }
  }
  std::cout << "largest relative errors: emission " << emission << ", environment " << sky << '\n';
  EXPECT_LT(emission, 1e-6);
  EXPECT_LT(sky, 5e-4);  // 2^-11: half of a half float's step
}

// Texels of one picture share their unit. What is up to 2^29 darker than the brightest keeps 0.1 %; beyond that it
// loses at most 2^-39 of the brightest, whose share in the light of the whole is 0.1 % of nothing.
TEST(Range, OfTexelsBesideABrightOne) {
  constexpr uint32_t kTexels = 512;
  const auto value = [](uint32_t x) { return static_cast<float>(std::pow(10.0, 6.0 - 12.0 * x / (kTexels - 1.0))); };
  const scene::Environment e = environmentOf(kTexels, 2, [&](uint32_t x, uint32_t) { return glm::vec3(value(x)); });
  const EnvironmentOracle stored(e);
  const double brightest = value(0);
  double worst = 0, sum = 0, exact = 0;
  for (uint32_t x = 0; x < kTexels; ++x) {
    const double v = value(x), off = std::abs(stored.texel(x, 0).r - v);
    EXPECT_LE(off, brightest * 0x1p-39 + v * 0x1p-11) << x;
    if (v > brightest * 0x1p-29) worst = std::max(worst, off / v);
    sum += stored.texel(x, 0).r;
    exact += v;
  }
  std::cout << "largest relative error of texels down to 2^-29: " << worst << ", of their sum " << sum / exact - 1
            << '\n';
  EXPECT_LT(worst, kEnergy);
  EXPECT_NEAR(sum / exact, 1, 5e-4);
}

// Vertex colours scale the albedo; from 2.5e-4 on the root's 16 bits are enough.
TEST(Range, OfVertexColours) {
  Builder b;
  scene::Primitive p = quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  double worst = 0;
  for (int i = 0; i <= 64; ++i) {
    const float v = std::pow(10.0f, -3.6f * static_cast<float>(i) / 64.0f);
    p.colors.assign(4, glm::vec4(v, v, v, 0.2f));
    b.scene.meshes.clear();
    b.scene.instances.clear();
    b.add(p);
    const scene::PreparedScene prepared = scene::prepareScene(b.scene);
    ASSERT_EQ(prepared.colors.size(), 4u);
    const double root = (prepared.colors[0].rg & 0xffffu) / 65535.0;
    worst = std::max(worst, std::abs(root * root / double(v) - 1));
    EXPECT_EQ(prepared.colors[0].ba >> 16, 13107u);
  }
  std::cout << "largest relative error of vertex colours from 2.5e-4 on: " << worst << '\n';
  EXPECT_LT(worst, kEnergy);
}

}  // namespace
}  // namespace weir::test
