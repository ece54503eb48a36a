// PackedSurface's rounding keeps what it rounds, in the mean: by itself, and through both G-buffers.
#include <gtest/gtest.h>
#include <weir/pass/plugin.h>

#include <cmath>

#include "../../passes/common/layouts.h"
#include "support/pass_test.h"
#include "support/small_scenes.h"

namespace weir::test {

struct Value {
  float value;
};
/// Differences from the value; of the normal, lengths of differences of unit vectors.
struct Rounded {
  float fine, coarse;                ///< means over all uniform numbers, 11 and 10 bits
  float nearestFine, nearestCoarse;  ///< rounded to the nearest
  float linear;                      ///< mean, 10 bits evenly spaced
  float normal, nearestNormal, farthest, pad;
};

}  // namespace weir::test

namespace weir {
template <>
struct LayoutOf<test::Value> {
  static constexpr const char* name = "Value";
  static constexpr uint32_t version = 1, emptyWord = 0;
  static constexpr std::array<Field, 1> fields{{{"float", "value"}}};
};
template <>
struct LayoutOf<test::Rounded> {
  static constexpr const char* name = "Rounded";
  static constexpr uint32_t version = 1, emptyWord = 0;
  static constexpr std::array<Field, 9> fields{{{"float", "fine"},
                                                {"float", "coarse"},
                                                {"float", "nearestFine"},
                                                {"float", "nearestCoarse"},
                                                {"float", "linear"},
                                                {"float", "normal"},
                                                {"float", "nearestNormal"},
                                                {"float", "farthest"},
                                                {"float", "pad"}}};
};
}  // namespace weir

namespace weir::test {
namespace {

class RoundingPass final : public Pass {
 public:
  static void describe(PassDescription& d) {
    d.input("values", perPixel<Value>());
    d.output("rounded", perPixel<Rounded>());
  }
  void prepare(PrepareContext& c) override { kernel_ = c.kernel("rounded.glsl"); }
  void record(RecordContext& c) override { c.launch(kernel_); }

 private:
  Kernel kernel_;
};

std::vector<Rounded> rounded(const std::vector<Value>& values) {
  PassTest t("packing_test.Rounding");
  t.plugin("packing_test", {passEntry<RoundingPass>("Rounding")}, sourcePath("tests/packing/shaders"));
  t.size(static_cast<uint32_t>(values.size()), 1).input("values", values);
  t.run();
  return t.output<Rounded>("rounded");
}

// Uniform numbers on a grid of 4096 leave at most half of its step of the gap between codes: at 0.001 and 10 bits,
// where the gap is 6 %, less than 1e-5 of the value.
TEST(Rounding, KeepsTheMeanOfAlbedo) {
  std::vector<Value> values;
  for (int i = 0; i < 512; ++i) values.push_back({std::pow(10.0f, -3.0f * static_cast<float>(i) / 511.0f)});
  const std::vector<Rounded> all = rounded(values);
  double fine = 0, coarse = 0, linear = 0, nearestFine = 0, nearestCoarse = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    const double v = values[i].value;
    fine = std::max(fine, std::abs(all[i].fine / v));
    coarse = std::max(coarse, std::abs(all[i].coarse / v));
    linear = std::max(linear, std::abs(double(all[i].linear)));
    nearestFine = std::max(nearestFine, std::abs(all[i].nearestFine / v));
    nearestCoarse = std::max(nearestCoarse, std::abs(all[i].nearestCoarse / v));
  }
  std::cout << "largest relative errors of the mean: 11 bits " << fine << ", 10 bits " << coarse
            << "; of rounding to the nearest: " << nearestFine << ", " << nearestCoarse << '\n';
  EXPECT_LT(fine, 1e-4);
  EXPECT_LT(coarse, 1e-4);
  EXPECT_LT(linear, 1e-6);
  // Without it the bounds above are broken by far: this test could fail.
  EXPECT_GT(nearestFine, 1e-2);
  EXPECT_GT(nearestCoarse, 2e-2);
}

TEST(Rounding, LeavesZeroAndOneAlone) {
  const std::vector<Rounded> all = rounded({{0.0f}, {1.0f}});
  for (const Rounded& r : all) {
    EXPECT_EQ(r.fine, 0.0f);
    EXPECT_EQ(r.coarse, 0.0f);
    EXPECT_EQ(r.linear, 0.0f);
  }
}

// Steps of 2^-15 are at most 7e-5 rad apart; their mean is off by the square of that, which single precision hides. The
// difference of the means is what light that grazes a plane sees, times tan θ.
TEST(Rounding, KeepsTheMeanOfNormals) {
  std::vector<Value> values;
  for (int i = 0; i < 512; ++i) values.push_back({static_cast<float>(uniformOf(i))});
  double mean = 0, nearest = 0, farthest = 0;
  for (const Rounded& r : rounded(values)) {
    mean = std::max(mean, double(r.normal));
    nearest = std::max(nearest, double(r.nearestNormal));
    farthest = std::max(farthest, double(r.farthest));
  }
  std::cout << "largest errors of normals, rad: mean " << mean << ", nearest " << nearest << ", farthest " << farthest
            << '\n';
  EXPECT_LT(mean, 1.5e-6);
  EXPECT_GT(nearest, 2e-5);
  EXPECT_LT(farthest, 1.4e-4);
}

glm::dvec3 albedoOf(uint32_t bits) {
  const glm::dvec3 s((bits & 2047u) / 2047.0, (bits >> 11 & 2047u) / 2047.0, (bits >> 22) / 1023.0);
  return s * s;
}

scene::Scene panel(const glm::vec3& color, float metallic, float roughness, float specular) {
  Builder b;
  scene::Material m;
  m.baseColor = glm::vec4(color, 1);
  m.metallic = metallic;
  m.roughness = roughness;
  m.specular = specular;
  b.add(quad({-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}, b.material(m)));
  return b.scene;
}

// Mean of what 64² pixels of 8 frames hold, 32768 values of two neighbouring codes each. Relative to the gap g between
// them its standard deviation is at most 1/(2 · 181); bounds are 5 of those: of 40 comparisons one fails by chance in
// 40 · 6e-7.
TEST(Rounding, ThroughBothGBuffers) {
  constexpr uint32_t kSide = 64, kFrames = 8;
  constexpr double kBound = 5.0 / (2 * 181.0);
  struct Case {
    glm::vec3 color;
    float metallic, roughness, specular;
  };
  for (const Case& c : {Case{{0.5f, 0.18f, 0.5f}, 0, 0.3f, 1}, Case{{0.9f, 0.0123f, 0.0517f}, 1, 0.7f, 1},
                        Case{{0.3f, 0.003f, 0.001f}, 0.5f, 0.123f, 0.37f}}) {
    SCOPED_TRACE(testing::Message() << "roughness " << c.roughness);
    std::vector<passes::PackedSurface> first;
    for (const char* type : {"gbuffer.RayTraced", "gbuffer.Raster"}) {
      SCOPED_TRACE(type);
      PassTest t(type);
      t.size(kSide, kSide)
          .scene(panel(c.color, c.metallic, c.roughness, c.specular))
          .camera(lookAt({0, 0, 1}, {0, 0, 0}));
      const bool f90 = t.prepared().traits.f90;
      EXPECT_EQ(f90, c.specular != 1.0f);
      glm::dvec3 diffuse(0), specular(0);
      double roughness = 0, grazing = 0;
      std::vector<std::vector<passes::PackedSurface>> frames;
      for (uint32_t f = 0; f < kFrames; ++f) {
        t.run();
        frames.push_back(t.output<passes::PackedSurface>("surface"));
        for (const passes::PackedSurface& s : frames.back()) {
          ASSERT_GT(s.distance, 0.0f);
          diffuse += albedoOf(s.diffuse);
          specular += albedoOf(s.specular);
          roughness += f90 ? (s.roughnessJitter >> 22) / 1023.0 : (s.roughnessJitter >> 16) / 65535.0;
          grazing += (s.roughnessJitter >> 16 & 63u) / 63.0;
        }
      }
      const double n = double{kFrames} * kSide * kSide;
      const glm::dvec3 color(c.color), bits(2047, 2047, 1023);
      const glm::dvec3 f0 = glm::mix(glm::dvec3(0.04 * c.specular), color, double(c.metallic));
      const auto expectMean = [&](const glm::dvec3& mean, const glm::dvec3& value) {
        for (int k = 0; k < 3; ++k) {
          const double gap = (2 * std::floor(std::sqrt(value[k]) * bits[k]) + 1) / (bits[k] * bits[k]);
          EXPECT_NEAR(mean[k], value[k], kBound * gap + 2e-7) << "channel " << k;
        }
      };
      expectMean(diffuse / n, color * (1.0 - c.metallic));
      expectMean(specular / n, f0);
      EXPECT_NEAR(roughness / n, c.roughness, kBound / (f90 ? 1023 : 65535) + 1e-7);
      if (f90) {
        EXPECT_NEAR(grazing / n, c.specular + (1 - c.specular) * c.metallic, kBound / 63 + 1e-7);
      }
      // Another frame rounds another way, and both G-buffers the same way.
      const auto different = [](const auto& a, const auto& b) {
        size_t count = 0;
        for (size_t i = 0; i < a.size(); ++i) {
          count += a[i].diffuse != b[i].diffuse || a[i].specular != b[i].specular ||
                   a[i].roughnessJitter != b[i].roughnessJitter || a[i].shadingNormal != b[i].shadingNormal;
        }
        return count;
      };
      EXPECT_GT(different(frames[0], frames[1]), kSide * kSide / 2u);
      if (first.empty()) first = frames[0];
      EXPECT_EQ(different(first, frames[0]), 0u);
    }
  }
}

}  // namespace
}  // namespace weir::test
