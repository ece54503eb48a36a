// Passes of the tests' own that ask bsdf.glsl and bsdf_sample.glsl about surfaces that no scene has, and what comes out
// by glTF 2.0, appendix B, in double precision.
#pragma once

#include <weir/pass/plugin.h>

#include <array>
#include <cmath>
#include <numbers>

#include "../../passes/common/layouts.h"
#include "support/pass_test.h"

namespace weir::test {

inline constexpr double kPi = std::numbers::pi;

struct Lobe {
  float nx, ny, nz, alpha, vx, vy, vz, f0, diffuse;
};
struct Drawn {
  float x, y, z, density;
};
struct Albedo {
  float value;
};

}  // namespace weir::test

namespace weir {

template <>
struct LayoutOf<test::Lobe> {
  static constexpr const char* name = "Lobe";
  static constexpr uint32_t version = 1, emptyWord = 0;
  static constexpr std::array<Field, 9> fields{{{"float", "nx"},
                                                {"float", "ny"},
                                                {"float", "nz"},
                                                {"float", "alpha"},
                                                {"float", "vx"},
                                                {"float", "vy"},
                                                {"float", "vz"},
                                                {"float", "f0"},
                                                {"float", "diffuse"}}};
};
template <>
struct LayoutOf<test::Drawn> {
  static constexpr const char* name = "Drawn";
  static constexpr uint32_t version = 1, emptyWord = 0;
  static constexpr std::array<Field, 4> fields{{{"float", "x"}, {"float", "y"}, {"float", "z"}, {"float", "density"}}};
};
template <>
struct LayoutOf<test::Albedo> {
  static constexpr const char* name = "Albedo";
  static constexpr uint32_t version = 1, emptyWord = 0;
  static constexpr std::array<Field, 1> fields{{{"float", "value"}}};
};

}  // namespace weir

namespace weir::test {

class Draw final : public Pass {
 public:
  static void describe(PassDescription& d) {
    d.input("lobes", perPixel<Lobe>());
    d.input("surface", perPixel<passes::PackedSurface>()).optional();  // surface.glsl names the struct
    d.output("drawn", perPixel<Drawn>());
    d.needs(Need::FrameIndex);
  }
  void prepare(PrepareContext& c) override { kernel_ = c.kernel("draw.glsl"); }
  void record(RecordContext& c) override { c.launch(kernel_); }

 private:
  Kernel kernel_;
};

class Furnace final : public Pass {
 public:
  static void describe(PassDescription& d) {
    d.input("lobes", perPixel<Lobe>());
    d.input("surface", perPixel<passes::PackedSurface>()).optional();  // surface.glsl names the struct
    d.output("albedo", perPixel<Albedo>());
  }
  void prepare(PrepareContext& c) override { kernel_ = c.kernel("albedo.glsl"); }
  void record(RecordContext& c) override { c.launch(kernel_); }

 private:
  Kernel kernel_;
};

inline PassTest& withLobes(PassTest& t) {
  return t.leaveOpen("surface").plugin("bsdf_test", {passEntry<Draw>("Draw"), passEntry<Furnace>("Furnace")},
                                       sourcePath("tests/bsdf/shaders"));
}

/// A surface that is seen at the cosine `nv`, tilted in the world.
inline Lobe lobe(double nv, double roughness, double f0, double diffuse) {
  const glm::dvec3 n = glm::normalize(glm::dvec3(0.3, -0.5, 0.8)), t = glm::normalize(glm::cross(n, {0.2, 0.9, 0.1}));
  const glm::dvec3 v = nv * n + std::sqrt(1 - nv * nv) * t;
  const double alpha = std::max(roughness * roughness, 1.0 / 2048);
  const glm::vec3 a(n), b(v);
  return {a.x, a.y, a.z, static_cast<float>(alpha), b.x, b.y, b.z, static_cast<float>(f0), static_cast<float>(diffuse)};
}

/// √(c² (1 - α²) + α²), as in Smith's G1 = 2 c / (c + that).
inline double smith(double c, double alpha) {
  return std::sqrt(c * c * (1 - alpha * alpha) + alpha * alpha);
}

/// What appendix B reflects of light from all around, seen at the cosine nv. The lobe is integrated over microfacets
/// (D cosθ dω = 2 ζ dζ dφ / 2π, ζ the height of the normal once slopes are divided by α), diffuse light over the half
/// sphere; 400 × 200 midpoints each.
inline double albedoByQuadrature(double nv, double alpha, double f0, double diffuse) {
  constexpr int kAcross = 400, kAround = 200;
  const double sine = std::sqrt(1 - nv * nv);
  const auto fresnel = [&](double vh) { return f0 + (1 - f0) * std::pow(1 - std::min(std::abs(vh), 1.0), 5); };
  double sum = 0;
  for (int i = 0; i < kAcross; ++i) {
    const double u = (i + 0.5) / kAcross;
    for (int k = 0; k < kAround; ++k) {
      const double cosine = std::cos(kPi * (k + 0.5) / kAround);  // the other half is the same
      const double slope = alpha * std::sqrt(1 - u * u) / u, scale = 1 / std::sqrt(1 + slope * slope);
      const double vh = (sine * slope * cosine + nv) * scale, nl = 2 * vh * scale - nv;
      if (vh > 0 && nl > 0) {
        const double visibility = 0.5 / (nl * smith(nv, alpha) + nv * smith(nl, alpha));
        sum += fresnel(vh) * 4 * visibility * nl * (vh / scale) * 2 * u / (kAcross * kAround);
      }
      if (diffuse == 0) continue;
      const double z = std::sqrt(1 - u), lv = std::sqrt(u) * cosine * sine + z * nv;
      sum += (1 - fresnel(std::sqrt(0.5 * (1 + lv)))) * diffuse / (kAcross * kAround);
    }
  }
  return sum;
}

}  // namespace weir::test
