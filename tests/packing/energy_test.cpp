// What rounding roughness does to the energy that a surface reflects: the directional albedo of GGX alone (F = 1), in
// double precision, for what PackedSurface's codes stand for.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/glm.hpp>
#include <iostream>
#include <numbers>

namespace weir::test {
namespace {

/// ∫ D V cosθ dω (height-correlated Smith) by visible normals: the mean of G2/G1 over Heitz's 2018 mapping of a square,
/// "Sampling the GGX Distribution of Visible Normals", JCGT 7(4), at 64² midpoints. The same points whatever the
/// roughness, so that differences are exact to far more digits than values.
double albedo(double roughness, double cosine) {
  const double a = roughness * roughness, sine = std::sqrt(1 - cosine * cosine);
  const auto lambda = [&](const glm::dvec3& v) {
    return 0.5 * (std::sqrt(1 + a * a * (v.x * v.x + v.y * v.y) / (v.z * v.z)) - 1);
  };
  const glm::dvec3 view(sine, 0, cosine), v = glm::normalize(glm::dvec3(a * view.x, 0, view.z));
  const glm::dvec3 t1(0, 1, 0), t2 = glm::cross(v, t1);
  constexpr int n = 64;
  double sum = 0;
  for (int i = 0; i < n * n; ++i) {
    const double r = std::sqrt((i / n + 0.5) / n), phi = 2 * std::numbers::pi * (i % n + 0.5) / n,
                 share = 0.5 * (1 + v.z);
    const double p1 = r * std::cos(phi), p2 = (1 - share) * std::sqrt(1 - p1 * p1) + share * r * std::sin(phi);
    const glm::dvec3 m = p1 * t1 + p2 * t2 + std::sqrt(std::max(0.0, 1 - p1 * p1 - p2 * p2)) * v;
    const glm::dvec3 h = glm::normalize(glm::dvec3(a * m.x, a * m.y, std::max(0.0, m.z)));
    const glm::dvec3 l = 2 * glm::dot(view, h) * h - view;
    if (l.z > 0) sum += (1 + lambda(view)) / (1 + lambda(view) + lambda(l));
  }
  return sum / (n * n);
}

struct Worst {
  double nearest = 0, random = 0;
};

Worst worstOf(double steps) {
  Worst w;
  for (const double cosine : {0.05, 0.2, 0.5, 1.0}) {
    for (double roughness = 0.03; roughness < 1; roughness += 0.0471) {
      // The worst place between two codes: half-way.
      const double low = std::floor(roughness * steps) / steps, high = low + 1 / steps, middle = 0.5 * (low + high);
      const double exact = albedo(middle, cosine);
      w.nearest = std::max(w.nearest, std::abs(albedo(high, cosine) / exact - 1));
      w.random = std::max(w.random, std::abs(0.5 * (albedo(low, cosine) + albedo(high, cosine)) / exact - 1));
    }
  }
  return w;
}

TEST(RoughnessEnergy, IsKept) {
  const Worst fine = worstOf(65535), coarse = worstOf(1023);
  std::cout << "largest relative errors of GGX's albedo: 16 bits " << fine.random << " (to the nearest " << fine.nearest
            << "), 10 bits " << coarse.random << " (" << coarse.nearest << ")\n";
  EXPECT_LT(fine.random, 1e-6);
  EXPECT_LT(coarse.random, 1e-4);
  EXPECT_GT(coarse.nearest, 10 * coarse.random);
  EXPECT_LT(coarse.nearest, 2e-3);
}

}  // namespace
}  // namespace weir::test
