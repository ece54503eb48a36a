#include "scene_support.h"

#include <cmath>
#include <limits>
#include <numeric>
#include <random>

namespace weir::scene {
namespace {

/// Every entry within 1e-6/n of weight/sum, and the whole is 1.
void expectExact(const std::vector<double>& weights, const std::string& what) {
  const auto table = buildAliasTable(weights);
  ASSERT_EQ(table.size(), weights.size()) << what;
  const double n = static_cast<double>(weights.size());
  long double sum = 0.0L, total = 0.0L;
  for (double w : weights) sum += w;
  const auto p = aliasProbabilities(table);
  double worst = 0.0;
  for (size_t i = 0; i < p.size(); ++i) {
    ASSERT_GE(table[i].threshold, 0.0f);
    ASSERT_LE(table[i].threshold, 1.0f);
    ASSERT_LT(table[i].alias, table.size());
    worst = std::max(worst, std::abs(p[i] - static_cast<double>(weights[i] / sum)) * n);
    total += p[i];
  }
  EXPECT_LT(worst, 1e-6) << what;
  EXPECT_NEAR(static_cast<double>(total), 1.0, 1e-12) << what;
}

TEST(AliasTable, ReproducesSmallAndSpecialWeights) {
  expectExact({1.0}, "one");
  expectExact({1.0, 1.0, 1.0}, "equal");
  expectExact({0.0, 3.0, 0.0, 1.0}, "with zeros");
  expectExact({1e-300, 1e300}, "three hundred decades up and down");
  expectExact({5e-324, 5e-324, 1e-323}, "denormal");
  expectExact(std::vector<double>(1000, 1e308), "a sum that overflows");
}

TEST(AliasTable, ReproducesRandomWeights) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (const size_t n : {2u, 7u, 100u, 4097u, 300000u}) {
    std::vector<double> flat(n), decades(n), needle(n, 1.0);
    for (double& w : flat) w = uniform(random);
    for (double& w : decades) w = std::pow(10.0, 30.0 * uniform(random) - 15.0);
    needle[n / 2] = 1e5;
    expectExact(flat, "flat " + std::to_string(n));
    expectExact(decades, "decades " + std::to_string(n));
    expectExact(needle, "needle " + std::to_string(n));
    needle[n / 2] = 1e12;
    expectExact(needle, "sharp needle " + std::to_string(n));
  }
}

TEST(AliasTable, NothingPositiveStaysPossibleAndNothingZeroIs) {
  std::mt19937_64 random(2);
  std::vector<double> weights(10000);
  for (double& w : weights) w = random() % 3 == 0 ? 0.0 : std::pow(10.0, static_cast<double>(random() % 20));
  const auto p = aliasProbabilities(buildAliasTable(weights));
  for (size_t i = 0; i < weights.size(); ++i) EXPECT_EQ(p[i] > 0.0, weights[i] > 0.0) << i;
}

TEST(AliasTable, AllZeroIsEmpty) {
  EXPECT_TRUE(buildAliasTable({}).empty());
  EXPECT_TRUE(buildAliasTable({0.0, 0.0}).empty());
}

TEST(AliasTable, RefusesBadWeights) {
  for (const double bad : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()})
    EXPECT_THROW(buildAliasTable({1.0, bad}), InputError) << bad;
}

// Pearson's chi-square of 10^6 draws over 50 cells. The bound is the 1 - 1e-6 quantile for 49 degrees of freedom
// (Wilson-Hilferty), so that a right table fails once in a million seeds; the seed is fixed.
TEST(AliasTable, DrawsFollowTheWeights) {
  const size_t n = 50;
  const uint64_t draws = 1'000'000;
  std::vector<double> weights(n);
  for (size_t i = 0; i < n; ++i) weights[i] = static_cast<double>(i * i % 17 + 1);
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  const auto table = buildAliasTable(weights);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  std::vector<uint64_t> counts(n, 0);
  for (uint64_t d = 0; d < draws; ++d) {
    const uint32_t cell = static_cast<uint32_t>(random() % n);
    ++counts[uniform(random) < table[cell].threshold ? cell : table[cell].alias];
  }
  double chi = 0.0;
  for (size_t i = 0; i < n; ++i) {
    const double expected = weights[i] / sum * static_cast<double>(draws);
    chi += (static_cast<double>(counts[i]) - expected) * (static_cast<double>(counts[i]) - expected) / expected;
  }
  const double k = n - 1, z = 4.753424;
  const double bound = k * std::pow(1.0 - 2.0 / (9.0 * k) + z * std::sqrt(2.0 / (9.0 * k)), 3.0);
  EXPECT_LT(chi, bound);
}

}  // namespace
}  // namespace weir::scene
