// Furnaces: what surfaces reflect of light from all around, with and without energy compensation.
// WEIR_FURNACE_JSON=FILE writes all figures there (docs/measurements/furnace.json).
#include <gtest/gtest.h>
#include <weir/scene/specular_albedo.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "bsdf/lobes.h"

namespace weir::test {
namespace {

constexpr uint32_t kGrid = 256;  // squared directions a surface

struct Case {
  double degrees, roughness, f0, diffuse;
};

double cosineOf(const Case& c) {
  return c.degrees == 90 ? 0 : std::cos(c.degrees * kPi / 180);
}

/// What the device's shaders reflect, by a deterministic quadrature on it.
std::vector<double> albedos(const std::vector<Case>& cases, bool compensated) {
  std::vector<Lobe> lobes;
  for (const Case& c : cases) lobes.insert(lobes.end(), kGrid, lobe(cosineOf(c), c.roughness, c.f0, c.diffuse));
  scene::Scene scene;
  scene.materials.emplace_back();
  scene.energyCompensation = compensated;
  PassTest t("bsdf_test.Furnace");
  withLobes(t).size(kGrid, static_cast<uint32_t>(cases.size())).scene(scene).input("lobes", lobes);
  EXPECT_EQ(t.prepared().traits.energyCompensation, compensated);
  t.run();
  const std::vector<Albedo> columns = t.output<Albedo>("albedo");
  std::vector<double> result;
  for (size_t i = 0; i < cases.size(); ++i) {
    double sum = 0;
    for (uint32_t k = 0; k < kGrid; ++k) sum += columns[i * kGrid + k].value;
    result.push_back(sum / kGrid);
  }
  return result;
}

/// An F0 = 1 metal at these angles.
std::vector<Case> white(const std::vector<double>& roughnesses) {
  std::vector<Case> cases;
  for (const double r : roughnesses)
    for (const double degrees : {0., 15., 30., 45., 60., 70., 80., 85., 88., 89., 89.5, 89.9, 89.99, 90.})
      cases.push_back({degrees, r, 1, 0});
  return cases;
}

// The bound is the project's. The table alone is within 7.2e-4, the quadrature within 3e-4.
TEST(Furnace, CompensatedMetalIsWhiteAtAnyRoughnessAndAngle) {
  std::vector<double> roughnesses = {0.0, 0.03};
  for (int i = 1; i <= 32; ++i) roughnesses.push_back(i / 32.0);
  const std::vector<Case> cases = white(roughnesses);
  const std::vector<double> with = albedos(cases, true), without = albedos(cases, false);
  double worst = 0, darkest = 1;
  for (size_t i = 0; i < cases.size(); ++i) {
    EXPECT_NEAR(with[i], 1, 0.002) << "roughness " << cases[i].roughness << ", " << cases[i].degrees << " degrees";
    worst = std::max(worst, std::abs(with[i] - 1));
    darkest = std::min(darkest, without[i]);
  }
  RecordProperty("worst", std::to_string(worst));
  std::cout << "furthest from 1: " << worst << "; without compensation down to " << darkest << "\n";
  EXPECT_NEAR(darkest, 1 - std::numbers::ln2, 1e-3) << "1 - ln 2 at α = 1 head on";
}

// At α = 1 facets are as often in any direction, and E = ∫ l / (l + v) dl = 1 - v ln(1 + 1/v).
TEST(Furnace, RoughestMetalHasAClosedForm) {
  const std::vector<Case> cases = white({1});
  const std::vector<double> without = albedos(cases, false);
  for (size_t i = 0; i < cases.size(); ++i) {
    const double v = cosineOf(cases[i]);
    EXPECT_NEAR(without[i], v > 0 ? 1 - v * std::log1p(1 / v) : 1, 5e-4) << cases[i].degrees << " degrees";
  }
}

// Every entry of the table, and what is read between four of them, against a quadrature that shares nothing with the
// program that wrote it.
TEST(Furnace, TableAgainstQuadrature) {
  constexpr uint32_t kColumns = scene::kSpecularAlbedoColumns, kRows = scene::kSpecularAlbedoRows;
  const std::vector<float> table = scene::specularAlbedoTable();
  ASSERT_EQ(table.size(), size_t{kColumns} * kRows);
  const auto exact = [](double column, double row) {
    const double alpha = std::max(row / (kRows - 1), 1e-6), u = std::pow(column / (kColumns - 1), 2);
    return albedoByQuadrature(std::min(alpha * u / (1 + alpha - u), 1.0), alpha, 1, 0);
  };
  for (uint32_t row = 0; row < kRows; row += 3) {
    for (uint32_t column = 0; column < kColumns; column += 3) {
      const float* at = &table[size_t{row} * kColumns + column];
      EXPECT_NEAR(*at, exact(column, row), 5e-4) << column << ", " << row;
      if (row + 1 == kRows || column + 1 == kColumns) continue;
      const double between = (double{at[0]} + at[1] + at[kColumns] + at[kColumns + 1]) / 4;
      EXPECT_NEAR(between / exact(column + 0.5, row + 0.5), 1, 1.2e-3) << column << ", " << row;
    }
  }
}

std::vector<Case> dielectricsAndMetals(const std::vector<double>& roughnesses) {
  std::vector<Case> cases;
  const std::vector<std::pair<double, double>> kinds = {
      {0, 1}, {0.02, 1}, {0.04, 1}, {0.0816326530612245, 1}, {1.0 / 9, 1}, {0.2, 0}, {0.5, 0}, {0.9, 0}, {1, 0}};
  for (const auto& [f0, diffuse] : kinds)
    for (const double r : roughnesses)
      for (const double degrees : {0., 30., 60., 75., 85., 89.}) cases.push_back({degrees, r, f0, diffuse});
  return cases;
}

// Dielectrics with an albedo of 1 from ior 1 to 2, and one channel of coloured metals.
TEST(Furnace, WithoutCompensationAppendixB) {
  const std::vector<Case> cases = dielectricsAndMetals({0.03, 0.25, 0.5, 1});
  const std::vector<double> found = albedos(cases, false);
  for (size_t i = 0; i < cases.size(); ++i) {
    const Case& c = cases[i];
    EXPECT_NEAR(found[i],
                albedoByQuadrature(cosineOf(c), std::max(c.roughness * c.roughness, 1.0 / 2048), c.f0, c.diffuse), 1e-3)
        << "F0 " << c.f0 << ", diffuse " << c.diffuse << ", roughness " << c.roughness << ", " << c.degrees
        << " degrees";
  }
}

// Compensation adds E_F F0 (1 - E) / E: something wherever F0 is, and, for metals, never more than what was lost.
TEST(Furnace, CompensationGivesBackNoMoreThanWasLost) {
  const std::vector<Case> cases = dielectricsAndMetals({0.1, 0.5, 1});
  const std::vector<double> without = albedos(cases, false), with = albedos(cases, true);
  for (size_t i = 0; i < cases.size(); ++i) {
    const Case& c = cases[i];
    SCOPED_TRACE(testing::Message() << "F0 " << c.f0 << ", roughness " << c.roughness << ", " << c.degrees
                                    << " degrees");
    const double alpha = c.roughness * c.roughness, nv = cosineOf(c);
    const double all = albedoByQuadrature(nv, alpha, 1, 0), lobe = albedoByQuadrature(nv, alpha, c.f0, 0);
    EXPECT_NEAR(with[i] - without[i], lobe * c.f0 * (1 - all) / all, 2e-3);
    if (c.diffuse == 0) {
      EXPECT_LE(with[i], without[i] + 1 - all + 2e-3);
      EXPECT_LE(with[i], 1.002);
    }
  }
}

TEST(Furnace, Figures) {
  const char* file = std::getenv("WEIR_FURNACE_JSON");
  if (file == nullptr) GTEST_SKIP() << "WEIR_FURNACE_JSON says where to";
  const std::vector<Case> cases = dielectricsAndMetals({0.03, 0.1, 0.25, 0.5, 0.75, 1});
  const std::vector<double> without = albedos(cases, false), with = albedos(cases, true);
  std::ofstream out(file);
  out << "{\"what\": \"albedo over the view's angle from the normal, appendix B and with energy compensation\",\n"
      << " \"by\": \"WEIR_FURNACE_JSON=FILE test_bsdf --gtest_filter=Furnace.Figures\", \"directions\": "
      << kGrid * kGrid << ",\n \"figures\": [\n";
  for (size_t i = 0; i < cases.size(); ++i) {
    const Case& c = cases[i];
    const nlohmann::json figure = {{"f0", c.f0},           {"diffuse", c.diffuse}, {"roughness", c.roughness},
                                   {"degrees", c.degrees}, {"albedo", without[i]}, {"compensated", with[i]}};
    out << figure.dump() << (i + 1 < cases.size() ? ",\n" : "\n]}\n");
  }
  EXPECT_TRUE(out.good()) << file;
}

}  // namespace
}  // namespace weir::test
