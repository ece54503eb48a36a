// What a bench makes of many pictures: fast relMSE, intervals, correlation time.
#include <weir/image/correlation_time.h>
#include <weir/image/interval.h>
#include <weir/image/metrics.h>
#include <weir/image/relative_error.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "support.h"

namespace weir::image {
namespace {

Picture noise(uint32_t width, uint32_t height, uint32_t seed, float scale) {
  std::mt19937 random(seed);
  std::lognormal_distribution<float> value(-1.0f, 1.5f);
  Picture p{width, height, std::vector<float>(size_t{4} * width * height), {}};
  for (float& v : p.rgba) v = scale * value(random);
  return p;
}

// Would fail if sums lost pieces at their edges, if the histogram cut at the wrong pixel, or the mean of what is kept
// were over all. Sizes below and above one piece of 65536 pixels.
TEST(RelativeErrorMeter, SaysWhatTheMetricsSay) {
  for (const auto& [width, height] : {std::pair(7u, 5u), std::pair(61u, 50u), std::pair(300u, 300u)}) {
    const Picture reference = noise(width, height, 1, 1.0f);
    RelativeErrorMeter meter(reference);
    for (uint32_t seed = 2; seed < 5; ++seed) {
      Picture test = noise(width, height, seed, 1.1f);
      if (seed == 4) test.rgba[4] = NAN, test.rgba[9] = INFINITY;
      const Metrics expected = measure(test, reference, {.flip = false});
      const PictureError found = meter.measure(test);
      EXPECT_NEAR(found.relMse / expected.relMse, 1.0, 1e-12);
      EXPECT_NEAR(found.trimmed / expected.relMseTrimmed, 1.0, 1e-6) << width << " " << seed;
      EXPECT_NEAR(found.relativeBias, expected.relativeBias, 1e-9);
      EXPECT_EQ(found.nonFinite, expected.nonFinite);
    }
  }
}

TEST(RelativeErrorMeter, TrimsEqualValuesAndFew) {
  EXPECT_TRUE(std::isnan(trimmedMean({})));
  const std::vector<float> few(999, 2.0f), many(4000, 3.0f);
  EXPECT_DOUBLE_EQ(trimmedMean(few), 2.0);
  EXPECT_DOUBLE_EQ(trimmedMean(many), 3.0);
  EXPECT_EQ(largestKept(many), 3.0f);
  std::vector<float> outliers(2000, 1.0f);
  outliers[17] = outliers[1999] = 1e30f;
  EXPECT_DOUBLE_EQ(trimmedMean(outliers), 1.0);
  EXPECT_EQ(largestKept(outliers), 1.0f);
  outliers[3] = 5.0f;  // the third largest stays
  EXPECT_NEAR(trimmedMean(outliers), (1997.0 + 5.0) / 1998.0, 1e-12);
  EXPECT_EQ(largestKept(outliers), 5.0f);
  const std::vector<float> zeros(3000, 0.0f);
  EXPECT_EQ(trimmedMean(zeros), 0.0);
}

TEST(RelativeErrorMeter, RefusesWhatIsNoReference) {
  Picture broken = constantPicture(4, 4, 1, 1, 1);
  broken.rgba[0] = NAN;
  EXPECT_THROW(RelativeErrorMeter{broken}, InputError);
  EXPECT_THROW(RelativeErrorMeter{Picture{}}, InputError);
  RelativeErrorMeter meter(constantPicture(4, 4, 1, 1, 1));
  EXPECT_THROW(meter.measure(constantPicture(4, 5, 1, 1, 1)), InputError);
  Picture nothing = constantPicture(4, 4, NAN, 1, 1);
  EXPECT_TRUE(std::isnan(meter.measure(nothing).relMse));
}

// 8000 intervals of 4 normal values each: the truth is in 95 % of them, σ of the count 0.24 %, so 1 % is four σ. With
// 1.96 in the place of Student's 3.18 it would be in 85 %; with n in the place of n - 1 in 93 %.
TEST(Interval, CoversTheTruthAsOftenAsItSays) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal(3.0, 2.0);
  constexpr int kTrials = 8000;
  int covered = 0;
  for (int i = 0; i < kTrials; ++i) {
    double values[4];
    for (double& v : values) v = normal(random);
    const Interval interval = meanInterval(values);
    covered += interval.low <= 3.0 && 3.0 <= interval.high;
  }
  EXPECT_NEAR(covered / double(kTrials), 0.95, 0.01);
}

TEST(Interval, JackknifeOfAMeanIsStudents) {
  const std::vector<double> values{1.0, 4.0, 2.5, 9.0, -3.0};
  const double sum = std::accumulate(values.begin(), values.end(), 0.0);
  std::vector<double> without;
  for (const double v : values) without.push_back((sum - v) / 4.0);
  const Interval a = meanInterval(values), b = jackknifeInterval(sum / 5.0, without);
  EXPECT_NEAR(a.low, b.low, 1e-12);
  EXPECT_NEAR(a.high, b.high, 1e-12);
}

TEST(Interval, SaysNothingOfTooFew) {
  const double one[] = {2.0}, bad[] = {1.0, NAN}, two[] = {1.0, 2.0};
  EXPECT_EQ(meanInterval(one).value, 2.0);
  EXPECT_TRUE(std::isnan(meanInterval(one).low));
  EXPECT_TRUE(std::isnan(meanInterval({}).value));
  EXPECT_TRUE(std::isnan(meanInterval(bad).value));
  EXPECT_TRUE(std::isnan(jackknifeInterval(1.0, two).low));
}

/// Sequences of frames reference + offset + noise whose autocorrelation is ρ^k, by pixel and channel independent.
struct Frames {
  uint32_t width = 50, height = 40, count = 200, repeats = 6;
  double time = 1.0;  // τ
  float offset = 0.0f;
  uint32_t wild = 0;  // so many pixels have independent noise of a thousand times the size

  Interval measure() const {
    const Picture reference = noise(width, height, 11, 1.0f);
    RelativeErrorMeter meter(reference);
    const double rho = (time - 1) / (time + 1);
    std::mt19937 random(99);
    std::normal_distribution<double> normal;
    std::vector<SequenceErrors> sequences;
    for (uint32_t r = 0; r < repeats; ++r) {
      std::vector<double> state(reference.rgba.size()), sum(state.size());
      for (double& s : state) s = normal(random);
      SequenceErrors one;
      one.errors.assign(reference.rgba.size() / 4, 0.0f);
      for (uint32_t f = 0; f < count; ++f) {
        Picture frame = reference;
        for (size_t i = 0; i < state.size(); ++i) {
          const bool strange = i / 4 < wild;
          state[i] = strange ? normal(random) : rho * state[i] + std::sqrt(1 - rho * rho) * normal(random);
          frame.rgba[i] += offset + static_cast<float>((strange ? 100.0 : 0.1) * state[i]);
          sum[i] += frame.rgba[i];
        }
        meter.measure(frame);
        for (size_t p = 0; p < one.errors.size(); ++p) one.errors[p] += meter.pixels()[p] / static_cast<float>(count);
      }
      one.mean = reference;
      for (size_t i = 0; i < sum.size(); ++i) one.mean.rgba[i] = static_cast<float>(sum[i] / count);
      sequences.push_back(std::move(one));
    }
    return correlationTime(sequences, reference, count);
  }
};

// 6000 values with 5 degrees of freedom: numerator known to sqrt(2 / 30000) = 0.8 %; 4 % is five σ.
TEST(CorrelationTime, FindsThatOfGeometricNoise) {
  for (const double time : {1.0, 3.0, 9.0}) {
    const Interval found = Frames{.time = time}.measure();
    EXPECT_NEAR(found.value / time, 1.0, 0.04) << time;
    EXPECT_LT(found.low, time * 1.04);
    EXPECT_GT(found.high, time * 0.96);
    EXPECT_LT(found.high - found.low, 0.5 * time);
  }
}

// 128 frames of τ = 40 show τ_N = 33.8 alone: without the correction for their number this fails.
TEST(CorrelationTime, SeesBeyondTheFramesThereAre) {
  EXPECT_NEAR((Frames{.count = 128, .time = 40}.measure().value), 40.0, 3.0);
}

// A biased estimator's frames are as alike as an unbiased one's: measured against the reference alone, τ would be near
// the number of frames.
TEST(CorrelationTime, DoesNotTakeABiasForCorrelation) {
  EXPECT_NEAR((Frames{.time = 3.0, .offset = 0.5f}.measure().value), 3.0, 0.12);
}

// Two wild pixels of 2000 would say τ = 1 for all of them.
TEST(CorrelationTime, IsNotThatOfAFewWildPixels) {
  EXPECT_NEAR((Frames{.time = 9.0, .wild = 2}.measure().value), 9.0, 0.4);
}

TEST(CorrelationTime, IsUnknownWithoutRepeatsOrNoise) {
  EXPECT_TRUE(std::isnan((Frames{.count = 4, .repeats = 1}.measure().value)));
  const Picture reference = constantPicture(8, 8, 1, 1, 1);
  const std::vector<SequenceErrors> still(3, {reference, std::vector<float>(64, 0.0f)});
  EXPECT_TRUE(std::isnan(correlationTime(still, reference, 16).value));
  const std::vector<SequenceErrors> other(3, {constantPicture(8, 9, 1, 1, 1), std::vector<float>(72, 0.0f)});
  EXPECT_THROW(correlationTime(other, reference, 16), InputError);
}

TEST(CorrelationTime, UndoesTheTruncation) {
  for (const double time : {0.4, 1.0, 7.0, 60.0}) {
    const double rho = (time - 1) / (time + 1);
    for (const uint64_t n : {16u, 256u}) {
      double seen = 1.0;  // straight from the definition
      for (uint64_t k = 1; k < n; ++k) seen += 2.0 * (1.0 - double(k) / double(n)) * std::pow(rho, double(k));
      EXPECT_NEAR(untruncatedTime(seen, n) / time, 1.0, 1e-6) << time << " " << n;
    }
  }
  EXPECT_TRUE(std::isinf(untruncatedTime(16.0, 16)));
  EXPECT_EQ(untruncatedTime(-0.1, 16), 0.0);
}

}  // namespace
}  // namespace weir::image
