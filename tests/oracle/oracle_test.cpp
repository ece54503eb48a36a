// The oracle itself against closed forms, so that it may judge others.
#include <gtest/gtest.h>
#include <weir/core/error.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "comparison.h"
#include "path.h"
#include "support/device.h"

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

Surface surfaceOf(double roughness, double nv) {
  Surface s;
  s.position = dvec3(0);
  s.normal = s.geometric = {0, 0, 1};
  s.view = {std::sqrt(1 - nv * nv), 0, nv};
  s.diffuse = {0.5, 0.3, 0.2};
  s.f0 = {0.04, 0.3, 0.9};
  s.alpha = roughness * roughness;
  return s;
}

/// glTF 2.0, appendix B, as the appendix writes it.
dvec3 appendixB(const Surface& s, const dvec3& l) {
  const double a2 = s.alpha * s.alpha, nl = l.z, nv = s.view.z;
  const dvec3 h = glm::normalize(l + s.view);
  const double nh = h.z, vh = glm::dot(s.view, h);
  const double d = a2 / (kPi * std::pow(nh * nh * (a2 - 1) + 1, 2.0));
  const double v = 1.0 / (nl * std::sqrt(a2 + (1 - a2) * nv * nv) + nv * std::sqrt(a2 + (1 - a2) * nl * nl)) / 2.0;
  const dvec3 f = s.f0 + (1.0 - s.f0) * std::pow(1 - std::abs(vh), 5.0);
  return ((1.0 - f) * s.diffuse / kPi + f * v * d) * nl;
}

TEST(OracleBsdf, IsAppendixB) {
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    const Surface s = surfaceOf(0.05 + 0.95 * random.next(), 0.02 + 0.98 * random.next());
    const dvec2 u = random.next2();
    const dvec3 l{std::sqrt(1 - u.x * u.x) * std::cos(2 * kPi * u.y),
                  std::sqrt(1 - u.x * u.x) * std::sin(2 * kPi * u.y), u.x};
    const dvec3 a = bsdfCos(s, l), b = appendixB(s, l);
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(a[c], b[c], 1e-9 * (1 + b[c]));
    EXPECT_EQ(bsdfCos(s, -l), dvec3(0));
  }
}

/// Samples follow their density: ∫ g over the sphere by both for a g that is uneven, each with its standard error.
TEST(OracleBsdf, SamplesFollowTheirDensity) {
  constexpr int kCount = 200000;
  int comparisons = 0;
  for (const double roughness : {0.15, 0.4, 1.0}) {
    for (const double nv : {0.08, 0.5, 0.95}) {
      const Surface s = surfaceOf(roughness, nv);
      Random random(7);
      const auto g = [](const dvec3& l) { return 1.0 + 0.5 * l.x + 0.3 * l.y + (l.z < 0 ? -0.4 : 0.4 * l.z); };
      image::Moments sampled, integral;
      for (uint64_t i = 1; i <= kCount; ++i) {
        sampled.add(g(sampleBsdf(s, random.next3())), i);
        // Directions of another surface with a wider lobe and none missing.
        const double z = 2 * random.next() - 1, turn = 2 * kPi * random.next(), r = std::sqrt(1 - z * z);
        Surface wide = s;
        wide.alpha = std::min(1.0, 2 * s.alpha);
        const bool uniform = random.next() < 0.5;
        const dvec3 l = uniform ? dvec3(r * std::cos(turn), r * std::sin(turn), z) : sampleBsdf(wide, random.next3());
        integral.add(g(l) * densityOfBsdf(s, l) / (0.5 / (4 * kPi) + 0.5 * densityOfBsdf(wide, l)), i);
      }
      const double error = std::hypot(sampled.standardError(kCount), integral.standardError(kCount));
      // 9 comparisons; 4.2 standard errors: 1 false alarm in 4000 for all.
      EXPECT_NEAR(sampled.mean, integral.mean, 4.2 * error) << roughness << " " << nv;
      EXPECT_LT(error, 0.01);
      ++comparisons;
    }
  }
  EXPECT_EQ(comparisons, 9);
}

TEST(OracleTextures, FilterAndLevels) {
  Image image{5, 2, {}};
  for (int i = 0; i < 10; ++i) image.texels.push_back({static_cast<uint8_t>(25 * i), 0, 255, 255});
  const Texture t(image, {}, false, false);
  const auto red = [&](double u, double v, double level = 0) { return t.at({u, v}, level).r * 255; };
  EXPECT_NEAR(red(0.3, 0.25), 25, 1e-9);    // a texel's centre
  EXPECT_NEAR(red(0.4, 0.25), 37.5, 1e-9);  // half way to the next
  EXPECT_NEAR(red(0.0, 0.25), 50, 1e-9);    // round the seam: between 100 and 0
  EXPECT_NEAR(red(1.3, -0.75), 25, 1e-9);   // repeats
  EXPECT_NEAR(red(0.3, 0.5), 87.5, 1e-9);   // half way down
  // Level 1 is 2 x 1: texels 2.5 wide, so (0 + 25 + 50/2) / 2.5 = 20 in the first row, 145 in the second.
  EXPECT_NEAR(red(0.25, 0.5, 1), 82.5, 1e-4);
  EXPECT_NEAR(red(0.1, 0.5, 9), 112.5, 1e-4);  // the last one: the mean
  EXPECT_NEAR(red(0.3, 0.25, 0.5), 0.5 * 25 + 0.5 * (0.9 * 82.5 + 0.1 * 142.5), 1e-4);
  const Texture colour(image, {}, true, false);
  EXPECT_NEAR(colour.at({0.7, 0.25}).r, std::pow((75 / 255.0 + 0.055) / 1.055, 2.4), 1e-12);
}

/// What the judge says of a picture that is brighter by a factor in one tile, with pixels' errors of 2 %: 0.125 % a
/// tile, and as much again for the other side.
Verdict verdictOf(double factor, double tolerance) {
  image::Picture a{64, 64, std::vector<float>(4 * 64 * 64, 1.0f), {}}, error = a, b = a;
  Random random(3);
  for (uint32_t y = 0; y < 64; ++y) {
    for (uint32_t x = 0; x < 64; ++x) {
      // Of mean 1 and variance 0.02².
      const double u = std::sqrt(12.0) * 0.02 * (random.next() - 0.5),
                   v = std::sqrt(12.0) * 0.02 * (random.next() - 0.5);
      for (int c = 0; c < 3; ++c) {
        a.at(x, y)[c] = static_cast<float>((1 + u) * (x / 16 == 2 && y / 16 == 1 ? factor : 1.0));
        b.at(x, y)[c] = static_cast<float>(1 + v);
        error.at(x, y)[c] = 0.02f;
      }
    }
  }
  return compare(a, error, b, error, 16, tolerance);
}

TEST(OracleComparison, FindsATileThatDiffers) {
  const Verdict same = verdictOf(1.0, 0.0), brighter = verdictOf(1.015, 0.0), tolerated = verdictOf(1.015, 0.02);
  EXPECT_TRUE(same.passed) << same.text();
  EXPECT_GT(same.worstT, 0.5);  // of 16: with errors as they are
  // The bound for 16 tiles is 3.42, the error of a difference 0.177 %: half of the tiles would show 0.6 %.
  EXPECT_NEAR(same.detectable, 3.42 * 0.00177, 1e-4);
  EXPECT_FALSE(brighter.passed) << brighter.text();
  EXPECT_EQ(brighter.left, 32u);
  EXPECT_EQ(brighter.top, 16u);
  EXPECT_TRUE(tolerated.passed) << tolerated.text();
}

TEST(OracleReader, RefusesWhatItDoesNotKnow) {
  const test::TemporaryFolder folder;
  const auto refusal = [&](const std::string& text) -> std::string {
    try {
      loadModel(folder.write("scene.gltf", text));
    } catch (const InputError& e) {
      return e.what();
    }
    return "accepted";
  };
  const std::string asset = R"("asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}])";
  EXPECT_NE(refusal("{" + asset + R"(,"extensionsUsed":["KHR_materials_clearcoat"]})").find("KHR_materials_clearcoat"),
            std::string::npos);
  EXPECT_NE(refusal("{" + asset + "}").find("meshes"), std::string::npos);
  EXPECT_NE(refusal("{" + asset + R"(,"meshes":[{"primitives":[{"attributes":{"POSITION":7}}]}],"accessors":[]})"),
            "accepted");
  EXPECT_NE(refusal("no JSON"), "accepted");
  EXPECT_NE(refusal(R"({"asset":{"version":"2.0"}})"), "accepted");
  EXPECT_THROW(loadModel(folder.path() + "/absent.glb"), InputError);
}

}  // namespace
}  // namespace weir::oracle
