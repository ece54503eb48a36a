// The specular lobe's sampler draws what its density says, at any angle and any α.
#include <gtest/gtest.h>

#include "bsdf/lobes.h"

namespace weir::test {
namespace {

constexpr uint32_t kColumns = 256, kRows = 64;  // samples of a lobe
constexpr int kHeights = 12, kAngles = 16;      // cells of visible normals

struct View {
  double nv, roughness;
};

/// A surface with the normal kept from facing away (finishSurface()). Where view and light all but cancel, at grazing
/// angles, the last bits of their lengths decide what is between them: where microfacets lie is told from vectors of
/// unit length, what the device says of them from the floats that it has.
struct Frame {
  Frame(const Lobe& l, bool unit) : normal(l.nx, l.ny, l.nz), view(l.vx, l.vy, l.vz), alpha(l.alpha) {
    if (unit) {
      normal = glm::normalize(normal);
      view = glm::normalize(view);
    }
    if (glm::dot(normal, view) < 0) normal = glm::normalize(normal - glm::dot(normal, view) * view);
    nv = std::max(glm::dot(normal, view), 0.0);
    sine = std::sqrt(std::max(1 - nv * nv, 0.0));
    across = glm::normalize(sine > 1e-3 ? view - nv * normal : glm::cross(normal, {0.6, 0.1, 0.3}));
  }
  /// The microfacet's normal that reflects the view into l, from the frame of the surface.
  glm::dvec3 half(const glm::dvec3& l) const {
    const glm::dvec3 h = glm::normalize(l + view);
    return {glm::dot(h, across), glm::dot(h, glm::cross(normal, across)), glm::dot(h, normal)};
  }
  glm::dvec3 normal, view, across;
  double alpha, nv = 0, sine = 0;
};

/// Visible normals have the density D max(v·h, 0) / A, A = (n·v + √(n·v² (1 - α²) + α²)) / 2 (Heitz 2014, eq. 14 and
/// 99). With ζ the height of the normal once slopes are divided by α, D cosθ dω = 2 ζ dζ dφ / 2π.
std::vector<double> expectedCells(const Frame& f) {
  constexpr int kFine = 64;
  std::vector<double> cells(kHeights * kAngles, 0.0);
  const double area = 0.5 * (f.nv + smith(f.nv, f.alpha));
  for (int i = 0; i < kHeights * kFine; ++i) {
    const double height = (i + 0.5) / (kHeights * kFine);
    for (int k = 0; k < kAngles * kFine; ++k) {
      const double angle = 2 * kPi * (k + 0.5) / (kAngles * kFine);
      const double seen = f.nv * height + f.sine * f.alpha * std::sqrt(1 - height * height) * std::cos(angle);
      cells[(i / kFine) * kAngles + k / kFine] +=
          std::max(seen, 0.0) / area * 2 / (kHeights * kFine) / (kAngles * kFine);
    }
  }
  return cells;
}

int cellOf(const Frame& f, const glm::dvec3& l) {
  const glm::dvec3 h = f.half(l), wide = glm::normalize(glm::dvec3(h.x / f.alpha, h.y / f.alpha, h.z));
  double angle = std::atan2(wide.y, wide.x) / (2 * kPi);
  if (angle < 0) angle += 1;
  const int i = std::clamp(static_cast<int>(wide.z * kHeights), 0, kHeights - 1);
  return i * kAngles + std::min(static_cast<int>(angle * kAngles), kAngles - 1);
}

/// Chance that Pearson's χ² is at least this large when nothing is wrong, by Wilson and Hilferty's approximation
/// (1931), which is good to a few per cent of it for the hundred cells here. Cells of fewer than 8 expected are pooled.
double chiSquareChance(const std::vector<uint64_t>& counts, const std::vector<double>& expected) {
  uint64_t all = 0, pooledCount = 0;
  for (const uint64_t c : counts) all += c;
  double chi = 0, pooled = 0;
  int cells = 0;
  const auto add = [&](double count, double mean) {
    chi += (count - mean) * (count - mean) / mean;
    ++cells;
  };
  for (size_t i = 0; i < counts.size(); ++i) {
    const double mean = expected[i] * static_cast<double>(all);
    if (mean >= 8) {
      add(static_cast<double>(counts[i]), mean);
    } else {
      pooled += mean;
      pooledCount += counts[i];
    }
  }
  if (pooled >= 8)
    add(static_cast<double>(pooledCount), pooled);
  else if (pooledCount > 40)
    return 0;  // Poisson: less than 1e-13
  const double freedom = cells - 1, spread = 2 / (9 * freedom);
  return 0.5 * std::erfc((std::cbrt(chi / freedom) - (1 - spread)) / std::sqrt(2 * spread));
}

// Chance of a false alarm: 1e-4 over all views. A view 1e-3 below the horizon stands for what packed normals round to.
TEST(BsdfSampler, DrawsWhatTheDensitySays) {
  std::vector<View> views;
  for (const double roughness : {0.0, 0.03, 0.1, 0.4, 0.7, 1.0})
    for (const double nv : {1.0, 0.8, 0.3, 0.05, 1e-3, 0.0, -1e-3}) views.push_back({nv, roughness});
  std::vector<Lobe> lobes;
  for (const View& v : views) lobes.insert(lobes.end(), kColumns * kRows, lobe(v.nv, v.roughness, 1, 0));
  PassTest t("bsdf_test.Draw");
  withLobes(t).size(kColumns, kRows * static_cast<uint32_t>(views.size())).input("lobes", lobes).seed(11);
  t.run();
  const std::vector<Drawn> drawn = t.output<Drawn>("drawn");
  ASSERT_EQ(drawn.size(), lobes.size());
  for (size_t v = 0; v < views.size(); ++v) {
    SCOPED_TRACE(testing::Message() << "n·v " << views[v].nv << ", roughness " << views[v].roughness);
    const Frame frame(lobes[v * kColumns * kRows], true), raw(lobes[v * kColumns * kRows], false);
    const double area = 0.5 * (frame.nv + smith(frame.nv, frame.alpha));
    std::vector<uint64_t> counts(kHeights * kAngles, 0);
    double worst = 0;
    for (uint32_t i = 0; i < kColumns * kRows; ++i) {
      const Drawn& d = drawn[v * kColumns * kRows + i];
      const glm::dvec3 l(d.x, d.y, d.z);
      ASSERT_NEAR(glm::length(l), 1, 1e-5) << "sample " << i;
      ++counts[cellOf(frame, glm::normalize(l))];
      const glm::dvec3 h = raw.half(l);
      const double a = frame.alpha, flat = h.x * h.x + h.y * h.y + a * a * h.z * h.z;
      const double density = a * a / (kPi * flat * flat) / (4 * area);  // D / 4 A
      worst = std::max(worst, std::abs(d.density / density - 1));
    }
    EXPECT_GT(chiSquareChance(counts, expectedCells(frame)), 1e-4 / static_cast<double>(views.size()));
    // The half vector is in floats: an error of 1e-7 in a slope of α and less, and density goes by the slope's fourth
    // power.
    EXPECT_LT(worst, 1e-4 + 2e-6 / frame.alpha);
  }
}

}  // namespace
}  // namespace weir::test
