// The oracle itself against closed forms, so that it may judge others.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "comparison.h"
#include "path.h"

namespace weir::oracle {
namespace {

constexpr double kPi = std::numbers::pi;
using glm::dvec2, glm::dvec3, glm::dvec4;

struct Builder {
  Model model;
  int material(const Material& m) {
    model.materials.push_back(m);
    return static_cast<int>(model.materials.size()) - 1;
  }
  /// Corners counter-clockwise as seen from the front.
  void quad(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d, int m) {
    for (const auto& corners : {std::array{a, b, c}, std::array{a, c, d}}) {
      Triangle t;
      t.position = corners;
      t.normal.fill(glm::normalize(glm::cross(b - a, d - a)));
      t.material = m;
      model.triangles.push_back(t);
    }
  }
};

/// Reflects by Lambert alone: KHR_materials_specular with a weight of 0 takes F0 and F90 away.
Material lambert(const dvec3& albedo) {
  Material m;
  m.baseColor = dvec4(albedo, 1);
  m.metallic = 0;
  m.specularWeight = 0;
  return m;
}

Material emitter(double nit) {
  Material m = lambert(dvec3(0));
  m.emission = dvec3(nit);
  return m;
}

constexpr dvec3 kAlbedo{0.6, 0.4, 0.2};

/// A floor in the plane y = 0.
Builder floorOf(const Material& m) {
  Builder b;
  b.quad({-9, 0, 9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9}, b.material(m));
  return b;
}

Camera cameraAt(const dvec3& eye, const dvec3& target, double degrees) {
  Camera c;
  c.eye = eye;
  c.forward = glm::normalize(target - eye);
  c.up = glm::normalize(dvec3(0, 1, 0) - c.forward * c.forward.y);
  c.verticalFov = glm::radians(degrees);
  return c;
}
const Camera kAbove = cameraAt({0.3, 2, 1.5}, {0, 0, 0}, 50);
constexpr uint32_t kSide = 24;

image::RestartAccumulator pictureOf(const Model& model, const Camera& camera, uint32_t bounces, uint32_t samples,
                                    uint32_t batches, bool everyPunctual = true) {
  const Tracer tracer(model);
  return render(model, tracer, camera,
                {.width = kSide,
                 .height = kSide,
                 .bounces = bounces,
                 .samples = samples,
                 .batches = batches,
                 .everyPunctual = everyPunctual,
                 .tile = 8});
}

/// Where a pixel's centre looks at the floor.
dvec3 onFloor(const Camera& c, uint32_t x, uint32_t y) {
  const double slope = std::tan(c.verticalFov / 2);
  const dvec2 p = (dvec2(x, y) + 0.5) / double{kSide} * 2.0 - 1.0;
  const dvec3 d = c.forward + slope * (p.x * glm::cross(c.forward, c.up) - p.y * c.up);
  return c.eye - d * (c.eye.y / d.y);
}

/// What the floor should show by a function of its points.
image::Picture expected(const std::function<dvec3(const dvec3&)>& at) {
  image::Picture p{kSide, kSide, std::vector<float>(4 * kSide * kSide, 1.0f), {}};
  for (uint32_t y = 0; y < kSide; ++y) {
    for (uint32_t x = 0; x < kSide; ++x) {
      const dvec3 c = at(onFloor(kAbove, x, y));
      for (int k = 0; k < 3; ++k) p.at(x, y)[k] = static_cast<float>(c[k]);
    }
  }
  return p;
}

void expectEqual(const image::Picture& a, const image::Picture& b) {
  for (size_t i = 0; i < a.rgba.size(); ++i) ASSERT_NEAR(a.rgba[i], b.rgba[i], 2e-6 + 2e-6 * std::abs(b.rgba[i])) << i;
}

/// False alarm: 1 in 100 for all tiles of a test together, and none once it has passed: seeds are fixed.
void expectMean(const image::RestartAccumulator& picture, const image::Picture& reference, double resolves) {
  const Verdict v = compare(image::tileTest(picture.tiles(), reference), 0.0);
  EXPECT_TRUE(v.passed) << v.text();
  EXPECT_LT(v.detectable, resolves) << v.text();
}

PunctualLight lightOf(PunctualLight::Kind kind, const dvec3& position, const dvec3& direction) {
  PunctualLight l;
  l.kind = kind;
  l.position = position;
  l.direction = glm::normalize(direction);
  l.intensity = {3, 2, 1};
  return l;
}

TEST(OracleClosedForms, PointLight) {
  Builder b = floorOf(lambert(kAlbedo));
  b.model.lights = {lightOf(PunctualLight::Kind::Point, {0.4, 1.2, -0.3}, {0, -1, 0})};
  const auto picture = pictureOf(b.model, kAbove, 0, 1, 2);
  expectEqual(picture.mean(), expected([&](const dvec3& p) {
                const dvec3 d = b.model.lights[0].position - p;
                return b.model.lights[0].intensity * kAlbedo / kPi * d.y / std::pow(glm::length(d), 3.0);
              }));
}

TEST(OracleClosedForms, SpotAndDirectionalLight) {
  Builder b = floorOf(lambert(kAlbedo));
  b.model.lights = {lightOf(PunctualLight::Kind::Spot, {0.2, 1.5, 0.1}, {0.1, -1, 0}),
                    lightOf(PunctualLight::Kind::Directional, {0, 0, 0}, {1, -2, 0.5})};
  b.model.lights[0].innerCone = 0.2;
  b.model.lights[0].outerCone = 0.5;
  b.model.lights[0].range = 2.0;
  expectEqual(pictureOf(b.model, kAbove, 0, 1, 2).mean(), expected([&](const dvec3& p) {
                const PunctualLight &spot = b.model.lights[0], &sun = b.model.lights[1];
                const dvec3 d = spot.position - p;
                const double r = glm::length(d), c = glm::dot(-d / r, spot.direction);
                const double t = c < std::cos(0.5)   ? 0.0
                                 : c > std::cos(0.2) ? 1.0
                                                     : (c - std::cos(0.5)) / (std::cos(0.2) - std::cos(0.5));
                const double window = std::max(0.0, 1.0 - std::pow(r / 2.0, 4.0));
                return kAlbedo / kPi *
                       (spot.intensity * (t * t * window * d.y / (r * r * r)) - sun.intensity * sun.direction.y);
              }));
}

/// One of many by what it brings unshadowed: the same mean as all of them.
TEST(OracleClosedForms, OnePunctualLightOfMany) {
  Builder b = floorOf(lambert(kAlbedo));
  b.quad({-0.5, 0.5, 0.2}, {0.2, 0.5, 0.2}, {0.2, 0.5, -0.4}, {-0.5, 0.5, -0.4}, 0);
  for (int i = 0; i < 9; ++i)
    b.model.lights.push_back(
        lightOf(PunctualLight::Kind::Point, {0.3 * (i % 3) - 0.3, 1.0, 0.3 * (i / 3) - 0.3}, {0, -1, 0}));
  expectMean(pictureOf(b.model, kAbove, 0, 16, 32, false), pictureOf(b.model, kAbove, 0, 1, 2).mean(), 0.02);
}

/// Lambert 1760: irradiance of a polygon of uniform radiance is L/2 Σ γ_i (Γ_i · n).
double polygonIrradiance(const std::vector<dvec3>& corners, const dvec3& p, const dvec3& n) {
  double sum = 0;
  for (size_t i = 0; i < corners.size(); ++i) {
    const dvec3 a = glm::normalize(corners[i] - p), b = glm::normalize(corners[(i + 1) % corners.size()] - p);
    sum += std::acos(glm::dot(a, b)) * glm::dot(glm::normalize(glm::cross(a, b)), n);
  }
  return std::abs(sum) / 2;
}

TEST(OracleClosedForms, QuadLight) {
  Builder b = floorOf(lambert(kAlbedo));
  const std::vector<dvec3> corners = {{-0.4, 0.5, 0.3}, {-0.4, 0.5, -0.3}, {0.5, 0.6, -0.3}, {0.5, 0.6, 0.3}};
  b.quad(corners[0], corners[1], corners[2], corners[3], b.material(emitter(5)));  // faces down
  const Camera low = cameraAt({0.3, 0.35, 1.5}, {0, 0, 0}, 30);                    // below the light's plane
  const auto picture = pictureOf(b.model, low, 0, 32, 32);
  image::Picture reference{kSide, kSide, std::vector<float>(4 * kSide * kSide, 1.0f), {}};
  const image::Picture seen = picture.mean();
  for (uint32_t y = 0; y < kSide; ++y) {
    for (uint32_t x = 0; x < kSide; ++x) {
      const dvec3 p = onFloor(low, x, y);
      const bool floor = std::abs(p.x) < 9 && std::abs(p.z) < 9 && p.z < low.eye.z;
      for (int k = 0; k < 3; ++k) {
        // Above the horizon: the light itself, or nothing.
        reference.at(x, y)[k] =
            floor ? static_cast<float>(5 * kAlbedo[k] / kPi * polygonIrradiance(corners, p, {0, 1, 0}))
                  : seen.at(x, y)[k];
      }
    }
  }
  expectMean(picture, reference, 0.02);
}

/// A closed box whose walls emit L and reflect ρ by Lambert: n bounces show L (1 + ρ + … + ρ^(n+1)) everywhere.
TEST(OracleClosedForms, Furnace) {
  for (const uint32_t bounces : {0u, 1u, 3u, 7u}) {
    Builder b;
    Material wall = lambert(dvec3(0.5, 0.8, 0.9));
    wall.emission = dvec3(1, 2, 3);
    const int m = b.material(wall);
    const double s = 1;
    b.quad({-s, -s, s}, {s, -s, s}, {s, -s, -s}, {-s, -s, -s}, m);
    b.quad({-s, s, -s}, {s, s, -s}, {s, s, s}, {-s, s, s}, m);
    b.quad({-s, -s, -s}, {s, -s, -s}, {s, s, -s}, {-s, s, -s}, m);
    b.quad({s, -s, s}, {-s, -s, s}, {-s, s, s}, {s, s, s}, m);
    b.quad({-s, -s, s}, {-s, -s, -s}, {-s, s, -s}, {-s, s, s}, m);
    b.quad({s, -s, -s}, {s, -s, s}, {s, s, s}, {s, s, -s}, m);
    dvec3 sum(0), power(1);
    for (uint32_t k = 0; k <= bounces + 1; ++k) {
      sum += power * wall.emission;
      power *= dvec3(wall.baseColor);
    }
    const auto picture = pictureOf(b.model, cameraAt({0.1, 0.2, 0.7}, {-0.3, 0, -1}, 70), bounces, 8, 16);
    expectMean(picture, expected([&](const dvec3&) { return sum; }), 0.05);
  }
}

/// One-sided emission: the same light seen from behind is dark and lights nothing.
TEST(OracleClosedForms, BacksOfLights) {
  for (const bool doubleSided : {false, true}) {
    Builder b = floorOf(lambert(kAlbedo));
    Material light = emitter(5);
    light.doubleSided = doubleSided;
    b.quad({-0.4, 0.5, 0.3}, {0.5, 0.5, 0.3}, {0.5, 0.5, -0.3}, {-0.4, 0.5, -0.3}, b.material(light));  // faces up
    const image::Picture p = pictureOf(b.model, cameraAt({0.3, 0.3, 1.5}, {0, 0.1, 0}, 40), 0, 4, 2).mean();
    double sum = 0;
    for (const float v : p.rgba) sum += v;
    const double alpha = kSide * kSide;
    if (doubleSided)
      EXPECT_GT(sum, alpha + 1);
    else
      EXPECT_EQ(sum, alpha);
  }
}

/// α at its smallest reflects like a mirror: the light's radiance, by directions of the BSDF.
TEST(OracleClosedForms, NearMirror) {
  Material metal;
  metal.roughness = 0;
  Builder b = floorOf(metal);
  b.quad({-99, 5, 99}, {-99, 5, -99}, {99, 5, -99}, {99, 5, 99}, b.material(emitter(2)));  // faces down
  expectMean(pictureOf(b.model, kAbove, 0, 16, 16), expected([](const dvec3&) { return dvec3(2); }), 0.02);
}

TEST(OracleClosedForms, AlphaBlend) {
  Builder b = floorOf(lambert(kAlbedo));
  Material glass = lambert(dvec3(0));
  glass.baseColor.a = 0.3;
  glass.alpha = Alpha::Blend;
  const int pane = b.material(glass);
  for (const double y : {0.6, 0.8}) b.quad({-9, y, 9}, {9, y, 9}, {9, y, -9}, {-9, y, -9}, pane);
  Camera below = kAbove;
  below.eye *= 0.25;
  b.model.lights = {lightOf(PunctualLight::Kind::Point, {0.4, 1.2, -0.3}, {0, -1, 0})};
  const auto lit = [&](const dvec3& p) {
    const dvec3 d = b.model.lights[0].position - p;
    return b.model.lights[0].intensity * kAlbedo / kPi * d.y / std::pow(glm::length(d), 3.0);
  };
  // From below the panes: exactly (1 - α)² of the light. The eye moved towards the origin looks at a quarter of each
  // point.
  expectEqual(pictureOf(b.model, below, 0, 1, 2).mean(),
              expected([&](const dvec3& p) { return 0.49 * lit(0.25 * p); }));
  // From above: the floor is seen with the probability (1 - α)², the panes are black.
  expectMean(pictureOf(b.model, kAbove, 0, 64, 16), expected([&](const dvec3& p) { return 0.49 * 0.49 * lit(p); }),
             0.05);
}

/// An emitter whose alpha is 0.25 shines with a quarter, found by its area and by directions alike.
TEST(OracleClosedForms, AlphaOfALight) {
  Builder b = floorOf(lambert(kAlbedo));
  const std::vector<dvec3> corners = {{-0.4, 2.1, 0.3}, {-0.4, 2.1, -0.3}, {0.5, 2.1, -0.3}, {0.5, 2.1, 0.3}};
  Material light = emitter(5);
  light.baseColor.a = 0.25;
  light.alpha = Alpha::Blend;
  b.quad(corners[0], corners[1], corners[2], corners[3], b.material(light));
  expectMean(pictureOf(b.model, kAbove, 0, 16, 32), expected([&](const dvec3& p) {
               return 0.25 * 5 * kAlbedo / kPi * polygonIrradiance(corners, p, {0, 1, 0});
             }),
             0.02);
}

}  // namespace
}  // namespace weir::oracle
