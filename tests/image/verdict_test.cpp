// Verdicts on synthetic restarts, whose truth is known: how often an unbiased estimator is called biased, whether
// planted biases are found and where, and that too little evidence is called that.
#include <gtest/gtest.h>
#include <weir/core/error.h>
#include <weir/image/student.h>
#include <weir/image/verdict.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "image/support.h"

namespace weir::image {
namespace {

constexpr uint32_t kFine = 4, kCoarse = 16;

/// An estimator: each fine tile has a brightness of its own; a restart multiplies it by 1 + noise, which is normal or
/// skewed, shared by the tile's pixels in part, and by its colours in part.
struct Synthetic {
  uint32_t width = 48, height = 32;
  double spread = 0.02;
  double bias = 0.0;
  int biasedTile = -1;  ///< fine tile with the bias; -1: all
  bool skewed = false;  ///< noise exponential - 1 instead of normal
  std::mt19937_64 random;

  explicit Synthetic(uint64_t seed) : random(seed) {}

  double truth(uint32_t x, uint32_t y) const { return 0.1 + 0.05 * double((x / kFine + 3 * (y / kFine)) % 11); }

  double noise() {
    return skewed ? std::exponential_distribution<double>(1.0)(random) - 1.0
                  : std::normal_distribution<double>()(random);
  }

  Picture picture(double s, double b) {
    Picture p = constantPicture(width, height, 0, 0, 0);
    const TileGrid grid{width, height, kFine};
    std::vector<std::array<double, 3>> factors(grid.count());
    for (size_t i = 0; i < factors.size(); ++i) {
      const double shared = noise();
      for (double& f : factors[i])
        f = 1 + s * (0.8 * shared + 0.6 * noise()) + (biasedTile < 0 || i == size_t(biasedTile) ? b : 0.0);
    }
    for (uint32_t y = 0; y < height; ++y) {
      for (uint32_t x = 0; x < width; ++x) {
        for (size_t c = 0; c < 3; ++c) p.at(x, y)[c] = float(truth(x, y) * factors[grid.index(x, y)][c]);
      }
    }
    return p;
  }

  EvidenceCollector collect(int restarts, double s, double b) {
    EvidenceCollector collector(kFine, kCoarse);
    for (int i = 0; i < restarts; ++i) collector.add(picture(s, b));
    return collector;
  }

  Picture exact() {
    const int tile = std::exchange(biasedTile, -1);
    Picture p = picture(0.0, 0.0);
    biasedTile = tile;
    return p;
  }

  Verdict verdict(int restarts, int referenceRestarts, const VerdictOptions& options = {}) {
    const EvidenceCollector measured = collect(restarts, spread, bias);
    const Evidence reference = referenceRestarts == 0 ? exactEvidence(exact(), kFine, kCoarse)
                                                      : collect(referenceRestarts, spread, 0.0).evidence();
    return decide(measured.evidence(), reference, measured.nonFinite(), options);
  }
};

/// Kolmogorov-Smirnov distance of values from the uniform distribution on [0, 1].
double distanceFromUniform(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  double most = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    const double n = double(values.size());
    most = std::max({most, std::abs(values[i] - double(i) / n), std::abs(values[i] - double(i + 1) / n)});
  }
  return most;
}

TEST(ShapeMoments, AgreeWithTheirDefinitions) {
  std::mt19937 random(1);
  std::vector<double> values;
  ShapeMoments m;
  for (uint64_t i = 1; i <= 50; ++i) {
    values.push_back(5.0 + std::exponential_distribution<double>(1.0)(random));
    m.add(values.back(), i);
  }
  double mean = 0, sums[5] = {};
  for (const double v : values) mean += v / 50;
  for (const double v : values) {
    for (int k = 2; k <= 4; ++k) sums[k] += std::pow(v - mean, k);
  }
  EXPECT_NEAR(m.mean, mean, 1e-12);
  EXPECT_NEAR(m.second, sums[2], 1e-9);
  EXPECT_NEAR(m.third, sums[3], 1e-9);
  EXPECT_NEAR(m.fourth, sums[4], 1e-8);
}

TEST(Estimates, HeavyTailsAreKnownBadly) {
  // One value of 1 among 64 makes all of the variance: hardly two degrees of freedom.
  ShapeMoments firefly, two;
  for (uint64_t i = 1; i <= 64; ++i) {
    firefly.add(i == 40 ? 1.0 : 0.0, i);
    two.add(i % 2 == 0 ? 1.0 : -1.0, i);
  }
  const Estimate e = estimate(firefly, 64);
  EXPECT_NEAR(e.mean, 1.0 / 64, 1e-12);
  EXPECT_NEAR(e.variance, 1.0 / (64 * 64), 1e-6);
  EXPECT_LT(e.freedom, 2.1);
  EXPECT_GT(e.cumulant, 0.0);
  // Two values that are equally likely have negative excess, which is not credited.
  EXPECT_EQ(estimate(two, 64).freedom, 63.0);
  EXPECT_TRUE(std::isinf(estimate(firefly, 1).variance));
}

TEST(Compare, WelchByHand) {
  // Welch 1947: variances of the means 0.04 (9 degrees) and 0.01 (4): ν = 0.05² / (0.04²/9 + 0.01²/4) = 12.33.
  const Comparison c = compare({1.5, 0.04, 9, 0}, {1.0, 0.01, 4, 0}, 0.0);
  EXPECT_NEAR(c.standardError, std::sqrt(0.05), 1e-12);
  EXPECT_NEAR(c.freedom, 12.329, 1e-3);
  EXPECT_NEAR(c.t, 0.5 / std::sqrt(0.05), 1e-12);
  EXPECT_NEAR(c.p, studentTTwoSided(c.t, 12), 1e-15);
  EXPECT_NEAR(c.relative, 0.5, 1e-12);
  // Skewed to the right, a mean that is too small alarms less; too large no more than plainly.
  const Comparison dark = compare({0.5, 0.05, 63, 0.05 * 0.05}, {1.0}, 0.0),
                   bright = compare({1.5, 0.05, 63, 0.0025}, {1.0}, 0.0);
  EXPECT_LT(std::abs(dark.t), bright.t);
  EXPECT_NEAR(bright.t, 0.5 / std::sqrt(0.05), 1e-12);
}

TEST(Compare, WhereNothingVaries) {
  EXPECT_EQ(compare({0.0}, {0.0}, 1e-5).p, 1.0);
  EXPECT_EQ(compare({1.000001}, {1.0}, 1e-5).p, 1.0);
  EXPECT_EQ(compare({1.0002}, {1.0}, 1e-5).p, 0.0);
  EXPECT_TRUE(std::isinf(compare({1e-6}, {0.0}, 1e-5).t));
  // Nothing known of one side: nothing said.
  EXPECT_EQ(compare({2.0, std::numeric_limits<double>::infinity(), 1.0}, {1.0}, 0.0).p, 1.0);
  EXPECT_EQ(compare({std::nan("")}, {1.0}, 0.0).p, 0.0);
}

// Of 250 verdicts on an unbiased estimator with alpha = 0.01, 2.5 alarms are expected at most; more than 9 have a
// probability of 0.0003 (binomial). The whole picture's p-values are uniform: a Kolmogorov-Smirnov distance above
// 1.95 / sqrt(250) has one of 0.001. Both kinds of reference, normal and skewed noise.
TEST(Verdict, FalseAlarmsAreAsRareAsAskedAndPValuesUniform) {
  for (const bool skewed : {false, true}) {
    for (const int reference : {0, 32}) {
      Synthetic s(7);
      s.skewed = skewed;
      s.width = 32;
      s.height = 16;
      int alarms = 0, unbiased = 0, missed = 0;
      std::vector<double> ps;
      for (int i = 0; i < 250; ++i) {
        const Verdict v = s.verdict(64, reference);
        alarms += v.answer == Answer::Biased;
        unbiased += v.answer == Answer::Unbiased;
        missed += v.low > 0 || v.high < 0;
        ps.push_back(v.whole.p);
      }
      const double distance = distanceFromUniform(ps);
      std::printf(
          "%s noise, %d restarts of the reference: %d of 250 biased, %d unbiased, interval missed %d times, KS %.3f\n",
          skewed ? "skewed" : "normal", reference, alarms, unbiased, missed, distance);
      EXPECT_LE(alarms, 9);
      EXPECT_LE(missed, 9);
      EXPECT_LT(distance, 1.95 / std::sqrt(250.0));
      EXPECT_GE(unbiased, 240);
    }
  }
}

// What peeking costs: eight looks at growing evidence, stopped at the first alarm, keep alpha when they are paid for.
TEST(Verdict, LooksArePaidFor) {
  int paid = 0, unpaid = 0;
  for (uint64_t seed = 0; seed < 300; ++seed) {
    Synthetic s(100 + seed);
    s.width = s.height = 16;
    const Evidence reference = exactEvidence(s.exact(), kFine, kCoarse);
    EvidenceCollector collector(kFine, kCoarse);
    bool alarmPaid = false, alarmUnpaid = false;
    for (int look = 1; look <= 8; ++look) {
      for (int i = 0; i < 16 * look; ++i) collector.add(s.picture(s.spread, 0));
      alarmPaid |= decide(collector.evidence(), reference, {}, {.alpha = 0.1, .looks = 8}).answer == Answer::Biased;
      alarmUnpaid |= decide(collector.evidence(), reference, {}, {.alpha = 0.1}).answer == Answer::Biased;
    }
    paid += alarmPaid;
    unpaid += alarmUnpaid;
  }
  std::printf("alarms of 300 with alpha 0.1: %d paid for, %d not\n", paid, unpaid);
  // 30 expected at most; above 48 has a probability of 0.0006.
  EXPECT_LE(paid, 48);
  EXPECT_GT(unpaid, paid + 20);
}

TEST(Verdict, FindsHalfAPercentEverywhere) {
  Synthetic s(8);
  s.spread = 0.02;
  s.bias = 0.005;
  for (int i = 0; i < 50; ++i) {
    const Verdict v = s.verdict(64, 64);
    ASSERT_EQ(v.answer, Answer::Biased);
    EXPECT_GT(v.low, 0.0);
    EXPECT_NEAR(v.whole.relative, 0.005, 0.002);
    EXPECT_FALSE(v.reasons.empty());
  }
}

TEST(Verdict, LocatesOneWrongTile) {
  Synthetic s(9);
  s.spread = 0.01;
  s.bias = -0.02;
  s.biasedTile = 29;  // column 5, row 2 of 12 x 8
  for (int i = 0; i < 50; ++i) {
    const Verdict v = s.verdict(64, 0);
    ASSERT_EQ(v.answer, Answer::Biased);
    ASSERT_EQ(v.fine.alarms, std::vector<size_t>{29});
    EXPECT_EQ(v.fine.worst, 29u);
    EXPECT_NEAR(v.fine.tiles[29].relative, -0.02, 0.006);
    bool said = false;
    for (const std::string& reason : v.reasons) said |= reason.find("at 20, 8") != std::string::npos;
    EXPECT_TRUE(said);
  }
}

TEST(Verdict, AShortRunIsUndecidedAndSaysHowLongWouldDo) {
  Synthetic s(10);
  s.width = s.height = 16;
  s.spread = 0.3;
  const VerdictOptions options{.tileTolerance = 1.0};
  double least = 1e30;
  for (int i = 0; i < 50; ++i) {
    const Verdict v = s.verdict(64, 64, options);
    ASSERT_EQ(v.answer, Answer::Undecided) << i;
    ASSERT_GT(v.enough, 64u);
    least = std::min(least, double(v.enough));
  }
  // That many are enough most of the time: 9 of 10 verdicts are asked for, and estimates of a spread of 64 restarts
  // vary by 9 %. Under 5 of 10 has a probability below 0.002.
  Synthetic longer(11);
  longer.width = longer.height = 16;
  longer.spread = 0.3;
  const auto count = static_cast<int>(least);
  std::printf("about %d restarts\n", count);
  int decided = 0;
  for (int i = 0; i < 10; ++i) decided += longer.verdict(count, count, options).answer == Answer::Unbiased;
  EXPECT_GE(decided, 5);
  // Few restarts decide nothing, however little they vary.
  Synthetic few(12);
  few.spread = 1e-4;
  few.bias = 0.01;
  const Verdict v = few.verdict(8, 0);
  EXPECT_EQ(v.answer, Answer::Undecided);
  EXPECT_EQ(v.enough, 16u);
}

TEST(Verdict, NonFiniteIsBiasedAndSaysWhere) {
  Synthetic s(13);
  EvidenceCollector measured = s.collect(20, 0.01, 0.0);
  Picture bad = s.picture(0.01, 0.0);
  bad.at(7, 3)[1] = std::numeric_limits<float>::quiet_NaN();
  bad.at(9, 3)[1] = std::numeric_limits<float>::infinity();
  measured.add(bad);
  EXPECT_EQ(measured.nonFinite().pixels, 2u);
  const Verdict v = decide(measured.evidence(), exactEvidence(s.exact(), kFine, kCoarse), measured.nonFinite());
  EXPECT_EQ(v.answer, Answer::Biased);
  ASSERT_EQ(v.reasons.size(), 1u);
  EXPECT_NE(v.reasons[0].find("2 pixels are not finite; the first is 7, 3 of restart 20"), std::string::npos)
      << v.reasons[0];
}

TEST(Verdict, BlackTilesAndBlackPictures) {
  Synthetic s(14);
  s.spread = 0.001;
  const auto blackened = [](Picture p) {
    for (uint32_t i = 0; i < 16; ++i) std::fill_n(p.at(i % 4, i / 4), 3, 0.0f);
    return p;
  };
  EvidenceCollector measured(kFine, kCoarse), leaking(kFine, kCoarse), nothing(kFine, kCoarse);
  for (int i = 0; i < 32; ++i) {
    Picture p = blackened(s.picture(s.spread, 0));
    measured.add(p);
    for (uint32_t k = 0; k < 16; ++k) std::fill_n(p.at(k % 4, k / 4), 3, 1e-4f * float(1 + i % 3));
    leaking.add(p);
    nothing.add(constantPicture(s.width, s.height, 0, 0, 0));
  }
  const Evidence reference = exactEvidence(blackened(s.exact()), kFine, kCoarse);
  EXPECT_EQ(decide(measured.evidence(), reference, {}).answer, Answer::Unbiased);
  const Verdict leak = decide(leaking.evidence(), reference, {});
  EXPECT_EQ(leak.answer, Answer::Biased);
  EXPECT_EQ(leak.fine.worst, 0u);
  const Evidence black = exactEvidence(constantPicture(s.width, s.height, 0, 0, 0), kFine, kCoarse);
  const Verdict none = decide(nothing.evidence(), black, {});
  EXPECT_EQ(none.answer, Answer::Undecided);
  ASSERT_FALSE(none.reasons.empty());
  EXPECT_NE(none.reasons[0].find("black"), std::string::npos);
  // Light where the reference has none at all: of a black reference nothing is known to be right.
  const Verdict lit = decide(measured.evidence(), black, {});
  EXPECT_EQ(lit.answer, Answer::Undecided);
  EXPECT_EQ(lit.reasons, none.reasons);
  EXPECT_EQ(lit.enough, 0u);
}

// A shift between colours that keeps luminance.
TEST(Verdict, SeesColours) {
  Synthetic s(15);
  EvidenceCollector measured(kFine, kCoarse);
  for (int i = 0; i < 32; ++i) {
    Picture p = s.picture(0.005, 0.0);
    for (size_t k = 0; k < p.rgba.size(); k += 4) {
      const float shift = 0.01f * p.rgba[k];
      p.rgba[k] += shift;
      p.rgba[k + 2] -= shift * 0.2126f / 0.0722f;
    }
    measured.add(p);
  }
  const Verdict v = decide(measured.evidence(), exactEvidence(s.exact(), kFine, kCoarse), {});
  EXPECT_GT(v.whole.p, v.wholeLevel);
  EXPECT_EQ(v.answer, Answer::Biased);
}

// A reference that is off by noise of its own: told its standard error, or left to find it out, the verdict stands;
// taken as exact, the noise is a bias.
TEST(Verdict, TheReferencesOwnErrorCounts) {
  int withError = 0, scatter = 0, exact = 0;
  for (uint64_t seed = 0; seed < 100; ++seed) {
    Synthetic s(200 + seed);
    s.spread = 0.002;
    const EvidenceCollector measured = s.collect(64, s.spread, 0.0);
    Picture reference = s.exact(), error = reference;
    std::normal_distribution<double> normal;
    for (size_t i = 0; i < reference.rgba.size(); ++i) {
      error.rgba[i] = 0.02f * reference.rgba[i];
      reference.rgba[i] += error.rgba[i] * float(normal(s.random));
    }
    const Evidence m = measured.evidence();
    withError += decide(m, pictureEvidence(reference, error, 32, kFine, kCoarse), {}).answer == Answer::Biased;
    scatter += decide(m, scatterEvidence(reference, measured.mean(), kFine, kCoarse), {}).answer == Answer::Biased;
    exact += decide(m, exactEvidence(reference, kFine, kCoarse), {}).answer == Answer::Biased;
  }
  // More than 5 of 100 with alpha = 0.01: 0.0005.
  EXPECT_LE(withError, 5);
  EXPECT_LE(scatter, 5);
  EXPECT_GE(exact, 95);
}

TEST(Verdict, ANoisyReferenceThatNoRunCanMakeUpForIsNamed) {
  Synthetic s(16);
  const EvidenceCollector measured = s.collect(64, 0.001, 0.0);
  const Picture reference = s.exact();
  Picture error = reference;
  for (float& v : error.rgba) v *= 0.5f;
  const Verdict v =
      decide(measured.evidence(), pictureEvidence(reference, error, 16, kFine, kCoarse), {}, {.tileTolerance = 10});
  EXPECT_EQ(v.answer, Answer::Undecided);
  EXPECT_EQ(v.enough, 0u);
  ASSERT_FALSE(v.reasons.empty());
  EXPECT_NE(v.reasons.back().find("no number of restarts"), std::string::npos) << v.reasons.back();
}

TEST(Verdict, RefusesWhatDoesNotFit) {
  Synthetic s(17);
  const Evidence e = s.collect(4, 0.01, 0).evidence();
  expectInputError([&] { decide(e, exactEvidence(constantPicture(8, 8, 1, 1, 1), kFine, kCoarse), {}); },
                   {"48x32", "8x8"});
  expectInputError([&] { decide(e, exactEvidence(s.exact(), 8, 16), {}); }, {"tiles"});
  expectInputError([&] { decide(exactEvidence(s.exact(), kFine, kCoarse), e, {}); }, {"restarts"});
  expectInputError([&] { EvidenceCollector(8, 20); }, {"20²", "8²"});
  Picture negative = s.exact();
  requireNotNegative(exactEvidence(negative, kFine, kCoarse), "r.exr");
  for (uint32_t k = 0; k < 16; ++k) negative.at(20 + k % 4, 8 + k / 4)[2] = -0.01f;
  expectInputError([&] { requireNotNegative(exactEvidence(negative, kFine, kCoarse), "r.exr"); },
                   {"r.exr is negative", "tile of 4² at 20, 8", "in B"});
  Picture error = s.exact();
  error.at(3, 2)[1] = -1.0f;
  expectInputError([&] { pictureEvidence(s.exact(), error, 8, kFine, kCoarse); }, {"3, 2", "-1"});
}

}  // namespace
}  // namespace weir::image
