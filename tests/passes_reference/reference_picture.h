// Pictures by reference.AllLights of small scenes, and the BSDF that they are compared with, written from glTF 2.0,
// appendix B, and KHR_materials_specular.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "../../passes/common/layouts.h"
#include "support/pass_test.h"
#include "support/ray_oracle.h"
#include "support/small_scenes.h"

namespace weir::test {

inline constexpr double kPi = std::numbers::pi;
inline constexpr uint32_t kSide = 24;

/// glTF 2.0, appendix B, times the cosine: (1-F) c/π + F D V.
inline glm::dvec3 bsdfCos(const OracleSurface& s, const glm::dvec3& view, const glm::dvec3& light) {
  const double nl = glm::dot(s.normal, light), nv = glm::dot(s.normal, view);
  if (nl <= 0 || glm::dot(s.geometricNormal, light) <= 0) return glm::dvec3(0);
  const glm::dvec3 h = glm::normalize(light + view);
  const double nh = glm::dot(s.normal, h), vh = glm::dot(view, h), a = std::max(s.roughness * s.roughness, 1.0 / 2048);
  const double d = a * a / (kPi * std::pow(nh * nh * (a * a - 1) + 1, 2));
  const double v =
      0.5 / (nl * std::sqrt(nv * nv * (1 - a * a) + a * a) + nv * std::sqrt(nl * nl * (1 - a * a) + a * a));
  const glm::dvec3 f = s.f0 + (s.f90 - s.f0) * std::pow(1 - vh, 5);
  return ((1.0 - f) * s.diffuse / kPi + f * d * v) * nl;
}

struct Picture {
  std::vector<glm::vec4> color;
  std::vector<passes::PackedSurface> surface;
};

/// G-buffer, then the pass under test on its surfaces; the mean of `frames`.
inline Picture render(const scene::Scene& scene, const scene::Camera& camera, int samples = 1, uint32_t frames = 1) {
  PassTest eye("gbuffer.RayTraced");
  eye.size(kSide, kSide).scene(scene).camera(camera);
  eye.run();
  Picture p;
  p.surface = eye.output<passes::PackedSurface>("surface");
  PassTest t("reference.AllLights");
  t.size(kSide, kSide).scene(scene).camera(camera).param("samples", std::to_string(samples));
  t.input("surface", p.surface).input("emission", eye.output<glm::vec4>("emission"));
  p.color.assign(size_t{kSide} * kSide, glm::vec4(0));
  for (uint32_t f = 0; f < frames; ++f) {
    t.run();
    const auto color = t.output<glm::vec4>("color");
    for (size_t i = 0; i < color.size(); ++i) p.color[i] += color[i] / static_cast<float>(frames);
  }
  return p;
}

/// Calls check(pixel, surface there, view, colour) for every pixel with a surface; returns their number.
template <typename Check>
size_t forSurfaces(const scene::Scene& scene, const scene::Camera& camera, const Picture& p, Check&& check) {
  const scene::PreparedScene prepared = scene::prepareScene(scene);
  const RayOracle oracle(scene, prepared);
  size_t n = 0;
  for (uint32_t i = 0; i < kSide * kSide; ++i) {
    const glm::dvec3 d = oracleDirection(camera, glm::dvec2(i % kSide, i / kSide) + 0.5, kSide, kSide);
    const OracleHit hit = oracle.closest(camera.eye, d, true);
    if (!hit || p.surface[i].distance == 0) continue;
    ++n;
    check(i, oracle.surface(hit, d), -d, glm::dvec3(p.color[i]));
  }
  return n;
}

/// A floor in the plane y = 0 around the origin, with a material of its own.
inline Builder floorOf(const glm::vec3& color, float metallic, float roughness) {
  Builder b;
  scene::Material m;
  m.baseColor = glm::vec4(color, 1);
  m.metallic = metallic;
  m.roughness = roughness;
  b.add(quad({-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}, b.material(m)));
  return b;
}

inline const scene::Camera kAbove = lookAt({0.3f, 2, 1.5f}, {0, 0, 0}, 50);
inline const glm::vec3 kIntensity(3, 2, 1);

/// Colours are packed in 10 or 11 bits, normals in 16: what that changes of a product of them.
inline void expectNear(const glm::dvec3& color, const glm::dvec3& expected, double relative, uint32_t pixel) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(color[c], expected[c], relative * expected[c] + 1e-7) << "pixel " << pixel;
}

}  // namespace weir::test
