// From values to colours: false colour, logarithms, signs, marks, and numbers at the ends of what floats hold.
#include <gtest/gtest.h>
#include <weir/core/error.h>

#include <cmath>
#include <limits>

#include "easel.h"

namespace weir::test {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kLargest = std::numeric_limits<float>::max();

/// A row of numbers, and what is shown of them.
class Colours : public ::testing::Test {
 protected:
  std::vector<Rgb> shown(const std::vector<float>& numbers, const view::PictureMode& mode) {
    const FilledPort port = easel.image(Format::R32F, static_cast<uint32_t>(numbers.size()), 1, numbers);
    easel.draw(port, channelNamed(port.resource, "R"), mode);
    const std::vector<uint8_t> pixels = easel.pixels();
    std::vector<Rgb> row;
    for (uint32_t x = 0; x < numbers.size(); ++x) row.push_back(Easel::at(pixels, x, 0));
    return row;
  }
  Easel easel;
};

double luminanceOf(const Rgb& c) {
  const auto linear = [](int code) {
    const double v = code / 255.0;
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * linear(c[0]) + 0.7152 * linear(c[1]) + 0.0722 * linear(c[2]);
}

TEST_F(Colours, FalseColourGrowsInLuminanceAllTheWay) {
  double last = -1.0;
  for (int part = 0; part < 4; ++part) {
    std::vector<float> numbers;
    for (int i = 0; i < 32; ++i) numbers.push_back(static_cast<float>(32 * part + i) / 127.0f);
    for (const Rgb& c : shown(numbers, {.falseColor = true})) {
      EXPECT_GT(luminanceOf(c), last);
      last = luminanceOf(c);
    }
  }
  EXPECT_LT(luminanceOf(shown({0.0f}, {.falseColor = true})[0]), 0.02);
  EXPECT_GT(last, 0.75);
}

TEST_F(Colours, WhatIsNotFiniteIsMagentaWhateverTheMode) {
  const std::vector<float> numbers{kNan, kInfinity, -kInfinity, 0.5f};
  for (const bool on : {false, true}) {
    for (const view::Sign sign : {view::Sign::Plain, view::Sign::Absolute, view::Sign::Split}) {
      const auto row = shown(numbers, {.falseColor = on, .logarithmic = on, .sign = sign, .markRange = on});
      for (int i = 0; i < 3; ++i) EXPECT_EQ(row[i], (Rgb{255, 0, 255}));
      EXPECT_NE(row[3], (Rgb{255, 0, 255}));
    }
  }
}

TEST_F(Colours, OneNanInAShrunkPictureStandsOut) {
  std::vector<float> numbers(64 * 64, 0.5f);
  numbers[64 * 17 + 33] = kNan;
  const FilledPort port = easel.image(Format::R32F, 64, 64, numbers);
  const view::Channel channel = channelNamed(port.resource, "R");
  view::Target target = easel.plainTarget();
  target.placement.scaleX = target.placement.scaleY = 0.125f;
  easel.draw({port, channel}, {}, target);
  const std::vector<uint8_t> pixels = easel.pixels();
  EXPECT_EQ(Easel::at(pixels, 33 / 8, 17 / 8), (Rgb{255, 0, 255}));
  expectNear(Easel::at(pixels, 0, 0), {128, 128, 128}, "elsewhere");
}

TEST_F(Colours, TheRangeIsMarkedOnDemand) {
  const std::vector<float> numbers{-0.1f, 0.0f, 0.5f, 1.0f, 1.1f};
  auto row = shown(numbers, {.markRange = true});
  EXPECT_EQ(row[0], (Rgb{0, 0, 255}));
  EXPECT_EQ(row[1], (Rgb{0, 0, 0}));
  EXPECT_EQ(row[3], (Rgb{255, 255, 255}));
  EXPECT_EQ(row[4], (Rgb{255, 0, 0}));
  row = shown(numbers, {.falseColor = true, .markRange = true});
  EXPECT_EQ(row[0], (Rgb{0, 0, 255}));
  EXPECT_EQ(row[4], (Rgb{255, 0, 0}));
  row = shown(numbers, {});
  EXPECT_EQ(row[0], (Rgb{0, 0, 0}));
  EXPECT_EQ(row[4], (Rgb{255, 255, 255}));
}

TEST_F(Colours, LogarithmsSpreadOrdersOfMagnitudeEvenly) {
  const std::vector<float> numbers{0.001f, 0.01f, 0.1f, 1.0f, 10.0f, 0.0f, -1.0f};
  auto row = shown(numbers, {.low = 0.001f, .high = 10.0f, .logarithmic = true});
  for (int i = 0; i < 5; ++i) {
    const int v = byteOf(i / 4.0);
    expectNear(row[i], {v, v, v}, "decade " + std::to_string(i));
  }
  EXPECT_EQ(row[5], (Rgb{0, 0, 0}));
  EXPECT_EQ(row[6], (Rgb{0, 0, 0}));
  row = shown(numbers, {.low = 0.001f, .high = 10.0f, .logarithmic = true, .markRange = true});
  EXPECT_EQ(row[5], (Rgb{0, 0, 255}));
  EXPECT_EQ(row[6], (Rgb{0, 0, 255}));
  row = shown(numbers, {.low = -2.0f, .high = -1.0f, .logarithmic = true, .markRange = true});
  EXPECT_EQ(row[0], (Rgb{255, 0, 0}));
  EXPECT_EQ(row[6], (Rgb{0, 0, 255}));
  // Without a positive start: 16 octaves.
  row = shown({1.0f, 1.0f / 256.0f, 1.0f / 65536.0f}, {.logarithmic = true});
  expectNear(row[0], {255, 255, 255}, "end");
  expectNear(row[1], {128, 128, 128}, "eight octaves below");
  expectNear(row[2], {0, 0, 0}, "start");
}

TEST_F(Colours, SignsAreTakenAwayOrToldApart) {
  const std::vector<float> numbers{-1.0f, -0.5f, 0.0f, 0.5f, 1.0f};
  auto row = shown(numbers, {.sign = view::Sign::Absolute});
  expectNear(row[1], {128, 128, 128}, "absolute");
  EXPECT_EQ(row[0], row[4]);
  row = shown(numbers, {.low = -1.0f, .high = 0.5f, .sign = view::Sign::Split});
  expectNear(row[0], {255, 0, 0}, "negative");
  expectNear(row[1], {128, 0, 0}, "half negative");
  expectNear(row[2], {0, 0, 0}, "zero");
  expectNear(row[3], {0, 128, 0}, "half positive");
  expectNear(row[4], {0, 255, 0}, "positive");
}

TEST_F(Colours, TheWidestRangeAndTheEmptyOneAreShown) {
  auto row = shown({-kLargest, 0.0f, kLargest}, {.low = -kLargest, .high = kLargest});
  expectNear(row[0], {0, 0, 0}, "least");
  expectNear(row[1], {128, 128, 128}, "zero");
  expectNear(row[2], {255, 255, 255}, "most");
  row = shown({0.4f, 0.5f, 0.6f}, {.low = 0.5f, .high = 0.5f});
  EXPECT_EQ(row[0], (Rgb{0, 0, 0}));
  EXPECT_EQ(row[1], (Rgb{255, 255, 255}));
  EXPECT_EQ(row[2], (Rgb{255, 255, 255}));
  // The mean of the largest numbers is finite.
  const std::vector<float> large(16, kLargest);
  const FilledPort port = easel.image(Format::R32F, 4, 4, large);
  const view::Channel channel = channelNamed(port.resource, "R");
  view::Target target = easel.plainTarget();
  target.placement.scaleX = target.placement.scaleY = 0.25f;
  easel.draw({port, channel}, {.low = 0.0f, .high = kLargest}, target);
  expectNear(Easel::at(easel.pixels(), 0, 0), {255, 255, 255}, "mean");
}

TEST_F(Colours, ModesOutOfBoundsAreRefused) {
  EXPECT_THROW(shown({0.0f}, {.low = kNan}), InputError);
  EXPECT_THROW(shown({0.0f}, {.high = kInfinity}), InputError);
  EXPECT_THROW(shown({0.0f}, {.exposure = 65.0f}), InputError);
  EXPECT_THROW(shown({0.0f}, {.exposure = kNan}), InputError);
}

}  // namespace
}  // namespace weir::test
