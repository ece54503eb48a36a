// Parts of the oracle: BSDF, its samples, textures, the judge of pictures, the reader.
#include <gtest/gtest.h>
#include <weir/core/error.h>

#include <cmath>
#include <numbers>

#include "comparison.h"
#include "path.h"
#include "support/device.h"

namespace weir::oracle {
namespace {

constexpr double kPi = std::numbers::pi;
using glm::dvec2, glm::dvec3;

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
