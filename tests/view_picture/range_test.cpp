// Ranges that suit what a port holds.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "easel.h"

namespace weir::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

view::Measurement measured(Easel& easel, const FilledPort& port, const view::Channel& channel) {
  easel.values({port, channel});
  const std::optional<view::Measurement> m = easel.meter().collect(0);
  EXPECT_TRUE(m.has_value());
  EXPECT_FALSE(easel.meter().collect(0).has_value()) << "once";
  return m.value_or(view::Measurement{});
}

TEST(PictureRange, SmallPicturesAreMeasuredExactly) {
  Easel easel;
  std::vector<float> values(101 * 10);
  for (size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i / 10);
  std::shuffle(values.begin(), values.end(), std::mt19937(1));
  values[500] = kNan;
  values[501] = std::numeric_limits<float>::infinity();
  const FilledPort port = easel.image(Format::R32F, 101, 10, values);
  const view::Measurement m = measured(easel, port, channelNamed(port.resource, "R"));
  EXPECT_EQ(m.channel, "R");
  EXPECT_EQ(m.finite, 1008u);
  EXPECT_EQ(m.others, 2u);
  EXPECT_EQ(m.low, 0.0f);
  EXPECT_EQ(m.high, 100.0f);
  EXPECT_NEAR(m.percentile1, 1.0f, 1.0f);
  EXPECT_NEAR(m.percentile99, 99.0f, 1.0f);
}

TEST(PictureRange, OfLargePicturesTheEndsAreExactAndPercentilesNear) {
  Easel easel;
  constexpr uint32_t kWidth = 700, kHeight = 500;
  std::vector<float> values(size_t{kWidth} * kHeight);
  std::mt19937 random(2);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  for (float& v : values) v = uniform(random);
  values[12345] = -7.0f;
  values[300000] = 900.0f;
  const FilledPort port = easel.image(Format::R32F, kWidth, kHeight, values);
  const view::Channel channel = channelNamed(port.resource, "R");
  const view::Measurement m = measured(easel, port, channel);
  EXPECT_EQ(m.finite, values.size());
  EXPECT_EQ(m.low, -7.0f);
  EXPECT_EQ(m.high, 900.0f);
  // A percentile of n uniform numbers has a standard deviation of √(0.01 · 0.99 / n), 0.0008 for the 128² cells: six of
  // them.
  EXPECT_NEAR(m.percentile1, 0.01f, 0.005f);
  EXPECT_NEAR(m.percentile99, 0.99f, 0.005f);
  const view::Range robust = view::rangeFor(m, channel, {});
  EXPECT_EQ(robust.low, m.percentile1);
  EXPECT_EQ(view::rangeFor(m, channel, {}, false).high, 900.0f);
}

TEST(PictureRange, LogarithmsBeginAtWhatIsPositive) {
  Easel easel;
  std::vector<float> values(100, 0.0f);
  for (size_t i = 50; i < 100; ++i) values[i] = static_cast<float>(i);
  const FilledPort port = easel.image(Format::R32F, 10, 10, values);
  const view::Channel channel = channelNamed(port.resource, "R");
  const view::Range range = view::rangeFor(measured(easel, port, channel), channel, {.logarithmic = true});
  EXPECT_NEAR(range.low, 50.0f, 1.0f);
  EXPECT_NEAR(range.high, 98.0f, 1.0f);
}

TEST(PictureRange, ColoursCountEachComponent) {
  Easel easel;
  const FilledPort port = easel.image(Format::RGBA32F, 2, 1, std::vector<float>{1, 2, 3, 99, -4, 5, 6, 99});
  const view::Measurement m = measured(easel, port, channelNamed(port.resource, "RGB"));
  EXPECT_EQ(m.low, -4.0f);
  EXPECT_EQ(m.high, 6.0f);
  EXPECT_EQ(m.finite, 2u);
}

TEST(PictureRange, SuitsTheMode) {
  view::Channel channel;
  view::Measurement m;
  m.finite = 10;
  m.low = m.percentile1 = -3.0f;
  m.high = m.percentile99 = 2.0f;
  view::Range r = view::rangeFor(m, channel, {.exposure = 1.0f});
  EXPECT_EQ(r.low, -3.0f);
  channel.exposed = true;
  r = view::rangeFor(m, channel, {.exposure = 1.0f});
  EXPECT_EQ(r.low, -6.0f);
  EXPECT_EQ(r.high, 4.0f);
  r = view::rangeFor(m, channel, {.sign = view::Sign::Absolute});
  EXPECT_EQ(r.low, 0.0f);
  EXPECT_EQ(r.high, 3.0f);
  // Never empty, never infinite.
  m.percentile1 = m.percentile99 = 5.0f;
  r = view::rangeFor(m, channel, {});
  EXPECT_LT(r.low, 5.0f);
  EXPECT_GT(r.high, 5.0f);
  m.percentile1 = m.percentile99 = std::numeric_limits<float>::max();
  r = view::rangeFor(m, channel, {.exposure = 10.0f});
  EXPECT_LT(r.low, r.high);
  EXPECT_TRUE(std::isfinite(r.high));
  m.finite = 0;
  EXPECT_EQ(view::rangeFor(m, channel, {.low = 0.25f, .high = 0.5f}).high, 0.5f);
}

TEST(PictureRange, NothingToSayIsNothingMeasured) {
  Easel easel;
  const FilledPort port = easel.image(Format::R32F, 3, 1, std::vector<float>{kNan, kNan, kNan});
  const view::Measurement m = measured(easel, port, channelNamed(port.resource, "R"));
  EXPECT_EQ(m.finite, 0u);
  EXPECT_EQ(m.others, 3u);
}

}  // namespace
}  // namespace weir::test
