// The running mean against double precision.
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "common/layouts.h"
#include "passes_output/one_pass.h"

namespace weir::test {
namespace {

using passes::MeanState;

std::string accumulate(int limit) {
  return R"({"type": "output.Accumulate", "inputs": {"color": "given.color", "history": "it.state@previous"}, "params": {"limit": )" +
         std::to_string(limit) + "}}";
}

/// Of very unlike sizes, so that a plain float sum would lose some.
std::vector<float> noise(std::mt19937& random, size_t pixels) {
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  std::vector<float> rgba(4 * pixels);
  for (float& x : rgba) x = std::exp2(16.0f * unit(random) - 8.0f);
  return rgba;
}

/// One unit in the last place of a float, and the rounding of the division.
void expectMean(const std::vector<float>& mean, const std::vector<double>& sum, double count) {
  for (size_t i = 0; i < mean.size(); ++i) {
    if (i % 4 == 3) continue;
    const double expected = sum[i] / count;
    ASSERT_NEAR(mean[i], expected, std::abs(expected) * 4e-7) << i;
  }
}

TEST(Accumulate, AThousandFramesAreTheirMean) {
  constexpr uint32_t kSide = 8;
  OnePass pass(accumulate(0), kSide, kSide);
  std::mt19937 random(3);
  std::vector<double> sum(4 * kSide * kSide);
  std::vector<float> last;
  for (int f = 0; f < 1000; ++f) {
    last = noise(random, kSide * kSide);
    for (size_t i = 0; i < sum.size(); ++i) sum[i] += last[i];
    pass.give(last);
  }
  const std::vector<float> mean = pass.read<float>("it.color");
  expectMean(mean, sum, 1000.0);
  EXPECT_EQ(mean[3], last[3]) << "alpha is this frame's";
  const std::vector<MeanState> state = pass.read<MeanState>("it.state");
  EXPECT_EQ(state[0].count, 1000.0f);
  EXPECT_NEAR(double{state[0].sumHigh[0]} + state[0].sumLow[0], sum[0], 1e-10 * sum[0]);
}

TEST(Accumulate, AfterAMillionFramesTheNextStillCounts) {
  // A float sum of a million ones moves in steps of 1/16: it would not see these frames at all.
  OnePass pass(accumulate(0), 1, 1);
  pass.give({0, 0, 0, 1});
  pass.write<MeanState>("it.state", {{{1e6f, 1e6f, -1e6f}, {0, 0, 0}, 1e6f, 0}});
  constexpr int kFrames = 500;
  for (int f = 0; f < kFrames; ++f) pass.give({0.01f, 1e-5f, -0.03f, 1});
  const MeanState state = pass.read<MeanState>("it.state")[0];
  const double added[] = {kFrames * double{0.01f}, kFrames * double{1e-5f}, kFrames * double{-0.03f}};
  const double before[] = {1e6, 1e6, -1e6};
  // Two floats hold 48 bits of the sum; the steps' own roundings add up to a few of the last.
  const double tolerance = std::ldexp(1e6, -44);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(double{state.sumHigh[k]} + state.sumLow[k] - before[k], added[k], tolerance) << k;
  }
  EXPECT_EQ(state.count, 1e6f + kFrames);
}

TEST(Accumulate, BigAndSmallCancelExactly) {
  OnePass pass(accumulate(0), 1, 1);
  for (const float x : {1e8f, 1.0f, -1e8f, 1.0f}) pass.give({x, x, x, 1});
  EXPECT_EQ(pass.read<float>("it.color"), (std::vector<float>{0.5f, 0.5f, 0.5f, 1}));
}

TEST(Accumulate, WithALimitItForgets) {
  constexpr int kLimit = 4;
  OnePass pass(accumulate(kLimit), 1, 1);
  double mean = 0.0;
  std::mt19937 random(5);
  for (int f = 0; f < 40; ++f) {
    const std::vector<float> rgba = noise(random, 1);
    mean += (rgba[0] - mean) / std::min(f + 1, kLimit);
    EXPECT_NEAR(pass.show(rgba)[0], mean, std::abs(mean) * 2e-6) << f;
  }
  EXPECT_EQ(pass.read<MeanState>("it.state")[0].count, kLimit);
}

TEST(Accumulate, ALimitOfOneIsThisFrame) {
  OnePass pass(accumulate(1), 1, 1);
  pass.give({5, 6, 7, 1});
  EXPECT_EQ(pass.show({1, 2, 3, 0}), (std::vector<float>{1, 2, 3, 0}));
}

TEST(Accumulate, WhatIsNotFiniteShowsAndALimitForgetsIt) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  OnePass truth(accumulate(0), 2, 1), screen(accumulate(8), 2, 1);
  for (OnePass* pass : {&truth, &screen}) {
    const std::vector<float> shown = pass->show({1, nan, 1, 1, 2, 2, 2, 1});
    EXPECT_TRUE(std::isnan(shown[1]));
    EXPECT_EQ(shown[4], 2.0f) << "not in the next pixel";
  }
  EXPECT_TRUE(std::isnan(truth.show({1, 1, 1, 1, 2, 2, 2, 1})[1]));
  EXPECT_EQ(screen.show({1, 1, 1, 1, 2, 2, 2, 1})[1], 1.0f);
}

}  // namespace
}  // namespace weir::test
