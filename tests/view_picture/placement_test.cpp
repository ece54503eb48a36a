// Where a picture lies: zoom and pan, shrinking, clips and splits, and what does not fit.
#include <gtest/gtest.h>
#include <weir/core/error.h>

#include <cmath>
#include <limits>

#include "easel.h"

namespace weir::test {
namespace {

constexpr Rgb kBackground{0x1c, 0x1c, 0x1c};

/// Number x + 100 y in every pixel.
FilledPort numbered(Easel& easel, uint32_t width, uint32_t height) {
  std::vector<float> values;
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x) values.push_back(static_cast<float>(x + 100 * y));
  return easel.image(Format::R32F, width, height, values);
}

FilledPort constant(Easel& easel, uint32_t width, uint32_t height, float value) {
  return easel.image(Format::R32F, width, height, std::vector<float>(size_t{width} * height, value));
}

TEST(PicturePlacement, EachCanvasPixelShowsThePixelUnderItsMiddle) {
  Easel easel;
  const FilledPort port = numbered(easel, 9, 7);
  const view::Channel channel = channelNamed(port.resource, "R");
  const view::Extent extent = view::extentOf(port.resource);
  for (const view::Placement& p : {view::Placement{0, 0, 1, 1}, view::Placement{10.3f, -3.7f, 5.5f, 5.5f},
                                   view::Placement{-20, 5, 64, 3}, view::Placement{3, 3, 0.5f, 0.5f}}) {
    view::Target target = easel.plainTarget();
    target.placement = p;
    easel.draw({port, channel}, {.low = 0.0f, .high = 700.0f, .box = false}, target);
    const std::vector<uint8_t> pixels = easel.pixels();
    for (uint32_t y = 0; y < Easel::kSide; ++y) {
      for (uint32_t x = 0; x < Easel::kSide; ++x) {
        const auto under = view::pixelAt(p, extent, static_cast<int32_t>(x), static_cast<int32_t>(y));
        const int v = under ? byteOf((under->x + 100 * under->y) / 700.0) : 0;
        expectNear(Easel::at(pixels, x, y), under ? Rgb{v, v, v} : kBackground, "canvas pixel");
      }
    }
  }
}

TEST(PicturePlacement, ShrunkPicturesShowMeansOfWhatACanvasPixelCovers) {
  Easel easel;
  const FilledPort port = numbered(easel, 60, 45);
  const view::Channel channel = channelNamed(port.resource, "R");
  view::Target target = easel.plainTarget();
  target.placement = {2.25f, 1.5f, 0.3f, 0.4f};
  easel.draw({port, channel}, {.low = 0.0f, .high = 4500.0f}, target);
  const std::vector<uint8_t> pixels = easel.pixels();
  const auto mean = [](double low, double high, double end) {  // of a coordinate over an interval, by pixels
    low = std::max(low, 0.0);
    high = std::min(high, end);
    double sum = 0;
    for (int i = 0; i < end; ++i) sum += i * std::max(0.0, std::min(high, i + 1.0) - std::max(low, double(i)));
    return sum / (high - low);
  };
  int compared = 0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      if (!view::pixelAt(target.placement, view::extentOf(port.resource), x, y)) continue;
      const double value =
          mean((x - 2.25) / 0.3, (x + 1 - 2.25) / 0.3, 60) + 100 * mean((y - 1.5) / 0.4, (y + 1 - 1.5) / 0.4, 45);
      const int v = byteOf(value / 4500);
      expectNear(Easel::at(pixels, x, y), {v, v, v}, "mean");
      ++compared;
    }
  }
  EXPECT_EQ(compared, 18 * 18);
}

TEST(PicturePlacement, TwoClipsSplitTheCanvas) {
  Easel easel;
  const FilledPort a = constant(easel, 64, 64, 0.25f), b = constant(easel, 32, 32, 0.75f);
  const view::Channel channel = channelNamed(a.resource, "R");
  constexpr uint32_t kLine = 23;
  view::Target left = easel.plainTarget(), right = left;
  left.clip = {0, 0, kLine, 64};
  right.clip = {kLine, 0, 64 - kLine, 64};
  right.placement = view::sameArea(left.placement, view::extentOf(a.resource), view::extentOf(b.resource));
  EXPECT_EQ(right.placement.scaleX, 2.0f);
  easel.picture().begin(1);
  easel.device().submitAndWait([&](VkCommandBuffer commands) {
    easel.picture().draw(commands, {a, channel}, {}, left);
    easel.picture().draw(commands, {b, channel}, {}, right);
  });
  const std::vector<uint8_t> pixels = easel.pixels();
  for (uint32_t y = 0; y < 64; ++y)
    for (uint32_t x = 0; x < 64; ++x) {
      const int v = byteOf(x < kLine ? 0.25 : 0.75);
      expectNear(Easel::at(pixels, x, y), {v, v, v}, "side");
    }
}

TEST(PicturePlacement, NothingIsWrittenBesideAClip) {
  Easel easel;
  const FilledPort dark = constant(easel, 64, 64, 0.0f), light = constant(easel, 64, 64, 1.0f);
  const view::Channel channel = channelNamed(dark.resource, "R");
  easel.draw(dark, channel, {});
  view::Target target = easel.plainTarget();
  // Partly and wholly beside the canvas, empty, and too large for 32 bits.
  for (const view::Rect& clip : {view::Rect{-5, 60, 10, 100}, view::Rect{70, 0, 10, 10}, view::Rect{5, 5, 0, 10},
                                 view::Rect{5, 5, 10, 0}, view::Rect{-2147483647, 3, 0xffffffffu, 1}}) {
    target.clip = clip;
    easel.draw({light, channel}, {}, target);
  }
  const std::vector<uint8_t> pixels = easel.pixels();
  for (uint32_t y = 0; y < 64; ++y)
    for (uint32_t x = 0; x < 64; ++x) {
      const bool inside = (x < 5 && y >= 60) || y == 3;
      EXPECT_EQ(Easel::at(pixels, x, y)[0], inside ? 255 : 0) << x << ", " << y;
    }
}

TEST(PicturePlacement, TinyAndFarPicturesLeaveBackground) {
  Easel easel;
  const FilledPort port = constant(easel, 64, 64, 1.0f);
  const view::Channel channel = channelNamed(port.resource, "R");
  view::Target target = easel.plainTarget();
  for (const view::Placement& p : {view::Placement{1e30f, 0, 1, 1}, view::Placement{0, -1e30f, 1e-30f, 1e-30f},
                                   view::Placement{-3e38f, 0, 1e38f, 1}}) {
    target.placement = p;
    easel.draw({port, channel}, {}, target);
    if (p.scaleX < 1e10f) {
      EXPECT_EQ(Easel::at(easel.pixels(), 20, 20), kBackground);
    }
  }
  target.placement = {10.75f, 10.75f, 1.0f / 64.0f, 1.0f / 64.0f};  // one canvas pixel in all
  easel.draw({port, channel}, {}, target);
  EXPECT_EQ(Easel::at(easel.pixels(), 10, 10), kBackground);
  EXPECT_EQ(Easel::at(easel.pixels(), 11, 11), (Rgb{255, 255, 255}));
  target.placement.x = target.placement.y = 10.0f;
  easel.draw({port, channel}, {}, target);
  EXPECT_EQ(Easel::at(easel.pixels(), 10, 10), (Rgb{255, 255, 255}));
  for (const float bad :
       {0.0f, -1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    target.placement = {0, 0, bad, 1};
    EXPECT_THROW(easel.draw({port, channel}, {}, target), InputError);
  }
}

TEST(PicturePlacement, WhatIsNoPortOfTheChannelIsRefused) {
  Easel easel;
  const FilledPort floats = constant(easel, 4, 4, 0.5f),
                   integers = easel.image(Format::R32U, 4, 4, std::vector<uint32_t>(16, 1u));
  const view::Channel channel = channelNamed(floats.resource, "R");
  EXPECT_THROW(easel.draw(integers, channel, {}), InputError);
  FilledPort none;
  none.resource = floats.resource;
  EXPECT_THROW(easel.draw(none, channel, {}), InputError);
  view::PortPicture one(easel.device(), easel.compiler(), 1, 1);
  EXPECT_THROW(one.begin(1), InputError);
  one.begin(0);
  easel.device().submitAndWait([&](VkCommandBuffer commands) {
    one.draw(commands, {floats, channel}, {}, easel.plainTarget());
    EXPECT_THROW(one.draw(commands, {floats, channel}, {}, easel.plainTarget()), InputError);
  });
}

TEST(PicturePlacement, FitsAndZoomsAboutAPoint) {
  const view::Placement p = view::fit({200, 100}, {10, 20, 100, 100});
  EXPECT_FLOAT_EQ(p.scaleX, 0.5f);
  EXPECT_FLOAT_EQ(p.x, 10.0f);
  EXPECT_FLOAT_EQ(p.y, 45.0f);
  const view::Placement whole = view::centred({31, 31}, {0, 0, 64, 64});
  EXPECT_EQ(whole.x, std::round(whole.x));
  const view::Placement z = view::zoomed(p, 60.0f, 70.0f, 8.0f);
  EXPECT_FLOAT_EQ((60.0f - p.x) / p.scaleX, (60.0f - z.x) / z.scaleX);
  EXPECT_FLOAT_EQ((70.0f - p.y) / p.scaleY, (70.0f - z.y) / z.scaleY);
  EXPECT_FLOAT_EQ(z.scaleX, 4.0f);
  EXPECT_LE(view::zoomed(z, 0, 0, 1e20f).scaleX, 1024.0f);
  EXPECT_GE(view::zoomed(z, 0, 0, 1e-20f).scaleX, 1.0f / 1025.0f);
  EXPECT_EQ(view::zoomed(z, 0, 0, std::numeric_limits<float>::quiet_NaN()).scaleX, z.scaleX);
  EXPECT_EQ(view::fit({0, 5}, {0, 0, 10, 10}).scaleX, 1.0f);
  EXPECT_EQ(view::pixelAt(p, {200, 100}, 9, 50), std::nullopt);
  EXPECT_EQ(view::pixelAt(p, {200, 100}, 10, 45), (view::PixelPlace{1, 1}));
}

}  // namespace
}  // namespace weir::test
