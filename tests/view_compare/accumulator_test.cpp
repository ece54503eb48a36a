// Sums on the device lose nothing over many frames, and say how far frames are apart.
#include <gtest/gtest.h>
#include <weir/gpu/barrier.h>

#include <cmath>
#include <limits>

#include "support/device.h"
#include "view/compare/accumulator.h"
#include "view/compare/picture_ring.h"

namespace weir::test {
namespace {

class AccumulatorTest : public ::testing::Test {
 protected:
  AccumulatorTest() {
    graph::Resource resource;
    resource.type = storageImage(Format::RGBA32F);
    resource.width = kWidth;
    resource.height = kHeight;
    frame_.image = gpu::Image(*device_, execute::imageDesc(*device_, resource), "frame");
    device_->submitAndWait([&](VkCommandBuffer commands) {
      const VkImageMemoryBarrier2 start = execute::toGeneral(frame_.image);
      VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
      info.imageMemoryBarrierCount = 1;
      info.pImageMemoryBarriers = &start;
      vkCmdPipelineBarrier2(commands, &info);
    });
  }
  void add(float r, float g, float b) {
    ++count_;
    device_->submitAndWait([&](VkCommandBuffer commands) {
      gpu::fullBarrier(commands);
      const VkClearColorValue color{{r, g, b, 1.0f}};
      const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
      vkCmdClearColorImage(commands, frame_.image.handle(), VK_IMAGE_LAYOUT_GENERAL, &color, 1, &all);
      accumulator_.record(commands, 0, frame_, count_);
    });
  }
  /// Of all pixels, which are alike.
  std::vector<float> mean() {
    view::PictureRing ring(*device_);
    ring.capture(accumulator_.mean(), 0);
    device_->waitIdle();
    const image::Picture picture = ring.take().at(0).picture();
    for (size_t i = 4; i < picture.rgba.size(); ++i) {
      const float a = picture.rgba[i], b = picture.rgba[i % 4];
      EXPECT_TRUE(a == b || (std::isnan(a) && std::isnan(b))) << "value " << i;
    }
    return {picture.rgba.begin(), picture.rgba.begin() + 4};
  }

  static constexpr uint32_t kWidth = 11, kHeight = 5;  // no multiples of a workgroup
  std::shared_ptr<gpu::Device> device_ = validatedDevice();
  ExpectNoValidationMessages guard_{*device_};
  shader::Compiler compiler_;
  view::Accumulator accumulator_{*device_, compiler_, kWidth, kHeight, 1};
  execute::Storage frame_;
  uint32_t count_ = 0;
};

TEST_F(AccumulatorTest, LosesNothingOverManyFrames) {
  // A plain float sum of 2000 times 0.1f is off by some 1e-5 of itself; the quotient's rounding is 1.2e-7 at most.
  const double wave[4] = {0.0, 0.05, 0.0, -0.05};
  double sum = 0, squares = 0;
  constexpr int kFrames = 2000;
  for (int i = 0; i < kFrames; ++i) {
    const auto value = static_cast<float>(0.1 + wave[i % 4]);
    add(0.1f, value, 1000.0f * value);
    sum += value;
    squares += double(value) * value;
  }
  const double m = sum / kFrames, variance = (squares - kFrames * m * m) / (kFrames - 1.0) / kFrames;
  const std::vector<float> mean = this->mean();
  EXPECT_NEAR(mean[0], 0.1f, 1.2e-8);
  EXPECT_NEAR(mean[1], m, 1.2e-7 * m);
  EXPECT_NEAR(mean[2], 1000 * m, 1.2e-4 * m);
  const double expected = (variance / (m * m + 0.01) + 1e6 * variance / (1e6 * m * m + 0.01)) / 3;
  EXPECT_NEAR(mean[3], expected, 1e-5 * expected);
}

TEST_F(AccumulatorTest, OneFrameIsItselfAndFramesThatAreAlikeHaveNoError) {
  add(0.25f, 0.5f, -2.0f);
  EXPECT_EQ(mean(), (std::vector<float>{0.25f, 0.5f, -2.0f, 0.0f}));
  add(0.25f, 0.5f, -2.0f);
  EXPECT_EQ(mean(), (std::vector<float>{0.25f, 0.5f, -2.0f, 0.0f}));
}

TEST_F(AccumulatorTest, WhatIsNotFiniteShowsUntilItStartsOver) {
  add(0.25f, 0.5f, 1.0f);
  add(std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 1.0f);
  add(0.25f, 0.5f, 1.0f);
  EXPECT_FALSE(std::isfinite(mean()[0]));
  EXPECT_FALSE(std::isfinite(mean()[1]));
  EXPECT_EQ(mean()[2], 1.0f);
  count_ = 0;
  add(0.5f, 0.25f, 3.0f);
  EXPECT_EQ(mean(), (std::vector<float>{0.5f, 0.25f, 3.0f, 0.0f}));
}

}  // namespace
}  // namespace weir::test
