// FLIP by its properties and by values that follow from the papers by hand. compare_independent.py has the comparison
// with a second implementation, and says what is published and what is derived.
#include <gtest/gtest.h>
#include <weir/core/error.h>
#include <weir/image/flip.h>
#include <weir/image/metrics.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "image/support.h"

namespace weir::image {
namespace {

double meanOf(const std::vector<float>& map) {
  return std::accumulate(map.begin(), map.end(), 0.0) / double(map.size());
}

Picture scaled(Picture picture, float factor) {
  for (size_t i = 0; i < picture.rgba.size(); ++i) {
    if (i % 4 != 3) picture.rgba[i] *= factor;
  }
  return picture;
}

TEST(Flip, EqualIsZeroEverywhereInRange) {
  const Picture a = randomPicture(50, 40, 1), b = randomPicture(50, 40, 2);
  for (const float v : ldrFlip(a, a, kDefaultPixelsPerDegree)) ASSERT_EQ(v, 0.0f);
  for (const float v : hdrFlip(a, a, kDefaultPixelsPerDegree)) ASSERT_EQ(v, 0.0f);
  for (const auto& map : {ldrFlip(a, b, 67), hdrFlip(scaled(a, 100), scaled(b, 1e-3f), 67), ldrFlip(a, b, 5)}) {
    for (const float v : map) {
      ASSERT_GE(v, 0.0f);
      ASSERT_LE(v, 1.0f);
    }
  }
}

TEST(Flip, LdrIsSymmetric) {
  const Picture a = randomPicture(50, 40, 1), b = randomPicture(50, 40, 2);
  EXPECT_EQ(ldrFlip(a, b, 67), ldrFlip(b, a, 67));
}

TEST(Flip, ConstantColoursByHand) {
  // Constant pictures pass every filter unchanged and have no features: FLIP is the colour term alone.
  const Picture black = constantPicture(40, 30, 0, 0, 0), white = constantPicture(40, 30, 1, 1, 1);
  const Picture green = constantPicture(40, 30, 0, 1, 0), blue = constantPicture(40, 30, 0, 0, 1);
  // Green and blue are the farthest pair by definition.
  for (const float v : ldrFlip(green, blue, 67)) ASSERT_NEAR(v, 1.0f, 1e-4f);
  // CIELAB of sRGB green (87.735, -86.183, 83.179) and blue (32.297, 79.188, -107.860), Hunt: a and b times L/100.
  const double far = std::pow(55.438 + std::hypot(-75.613 - 25.575, 72.977 + 34.836), 0.7);
  const double whiteBlack = std::pow(100.0, 0.7), knee = 0.4 * far;
  const double expected = 0.95 + 0.05 * (whiteBlack - knee) / (far - knee);
  for (const float v : ldrFlip(white, black, 67)) ASSERT_NEAR(v, expected, 1e-4);
  // Below the knee: greys with L* of 50 and 55 differ by 5.
  const auto grey = [](double l) {
    const double y = std::pow((l + 16) / 116, 3), s = 1.055 * std::pow(y, 1 / 2.4) - 0.055;
    return constantPicture(40, 30, float(s), float(s), float(s));
  };
  for (const float v : ldrFlip(grey(50), grey(55), 67)) ASSERT_NEAR(v, 0.95 * std::pow(5, 0.7) / knee, 1e-4);
}

TEST(Flip, DetailFadesWithDistance) {
  // A checkerboard of single pixels against its mean luminance: seen near by, not from afar.
  Picture board = constantPicture(64, 64, 0, 0, 0);
  for (uint32_t y = 0; y < 64; ++y) {
    for (uint32_t x = 0; x < 64; ++x) {
      if ((x + y) % 2) std::fill_n(board.at(x, y), 3, 1.0f);
    }
  }
  const Picture grey = constantPicture(64, 64, 0.7353569f, 0.7353569f, 0.7353569f);  // sRGB of 0.5
  const auto centre = [&](double ppd) { return ldrFlip(board, grey, ppd)[32 * 64 + 32]; };
  EXPECT_GT(centre(5), 0.8f);
  EXPECT_GT(centre(5), 2 * centre(67));
  EXPECT_LT(centre(300), 0.01f);
}

TEST(Flip, AnEdgeThatIsMissingWeighsMoreThanItsColour) {
  Picture edge = constantPicture(64, 32, 0.4f, 0.4f, 0.4f);
  for (uint32_t y = 0; y < 32; ++y) {
    for (uint32_t x = 32; x < 64; ++x) std::fill_n(edge.at(x, y), 3, 0.6f);
  }
  const std::vector<float> map = ldrFlip(edge, constantPicture(64, 32, 0.4f, 0.4f, 0.4f), 67);
  const float atEdge = map[16 * 64 + 33], inside = map[16 * 64 + 60], outside = map[16 * 64 + 3];
  EXPECT_GT(atEdge, inside);
  EXPECT_EQ(outside, 0.0f);
  // Every row sees the same: borders are repeated, not darkened.
  for (uint32_t y = 0; y < 32; ++y) ASSERT_NEAR(map[y * 64 + 33], atEdge, 1e-4f);
}

TEST(Flip, HdrExposuresFollowTheReference) {
  // Half of the pixels at 1, half at 2^-6: the median (lower) is 2^-6.
  Picture picture = constantPicture(8, 8, 1, 1, 1);
  for (uint32_t y = 0; y < 4; ++y) {
    for (uint32_t x = 0; x < 8; ++x) std::fill_n(picture.at(x, y), 3, 0x1p-6f);
  }
  const FlipExposures e = flipExposures(picture);
  EXPECT_NEAR(e.stop - e.start, 6.0, 1e-4);
  EXPECT_GE(e.count, 6);
  EXPECT_LE(e.count, 7);
  // The start puts the brightest pixel to 0.85: (a x² + b x) / (c x² + d x + e) of the ACES fit at x = 0.6 · 2^start.
  const double x = 0.6 * std::exp2(e.start);
  EXPECT_NEAR(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.85, 1e-5);
  EXPECT_NEAR(flipExposures(scaled(picture, 8)).start, e.start - 3, 1e-4);
  EXPECT_EQ(flipExposures(constantPicture(4, 4, 0, 0, 0)).count, 1);
  EXPECT_EQ(flipExposures(constantPicture(4, 4, 3, 3, 3)).count, 2);
}

// The authors publish that their HDR pair is looked at from -12.5423 to +0.9427 stops in 14 exposures. The pair isn't
// here, but brightest and median luminance follow from the two ends, and with them a picture of which the same must be
// true.
TEST(Flip, HdrExposuresOfThePublishedPair) {
  const double shoulder = std::exp2(flipExposures(constantPicture(1, 1, 1, 1, 1)).start);
  const auto median = float(shoulder * std::exp2(-0.9427)), brightest = float(shoulder * std::exp2(12.5423));
  Picture picture = constantPicture(5, 5, median, median, median);
  std::fill_n(picture.at(2, 2), 3, brightest);
  const FlipExposures e = flipExposures(picture);
  EXPECT_NEAR(e.start, -12.5423, 1e-4);
  EXPECT_NEAR(e.stop, 0.9427, 1e-4);
  EXPECT_EQ(e.count, 14);
}

TEST(Flip, HdrIgnoresACommonScaleAndSeesHighlights) {
  const Picture reference = randomPicture(40, 30, 1);
  Picture test = reference;
  for (int c = 0; c < 3; ++c) test.at(20, 15)[c] = 50.0f;  // a firefly
  const std::vector<float> map = hdrFlip(test, reference, 67),
                           bigger = hdrFlip(scaled(test, 64), scaled(reference, 64), 67);
  for (size_t i = 0; i < map.size(); ++i) ASSERT_NEAR(map[i], bigger[i], 1e-3);
  EXPECT_EQ(std::max_element(map.begin(), map.end()) - map.begin(), 15 * 40 + 20);
  EXPECT_GT(map[15 * 40 + 20], 0.2f);
  EXPECT_EQ(map[0], 0.0f);
}

TEST(Flip, HdrSurvivesExtremes) {
  const Picture black = constantPicture(8, 8, 0, 0, 0), bright = constantPicture(8, 8, 1e38f, 1e38f, 1e38f);
  const Picture dim = constantPicture(8, 8, 1e-38f, 0, 0), negative = constantPicture(8, 8, -1, -1, -1);
  for (const Picture* a : {&black, &bright, &dim, &negative}) {
    for (const Picture* b : {&black, &bright, &dim, &negative}) {
      for (const float v : hdrFlip(*a, *b, 67)) ASSERT_TRUE(v >= 0 && v <= 1);
    }
  }
  EXPECT_EQ(meanOf(hdrFlip(negative, black, 67)), 0.0);
}

TEST(Flip, SmallPicturesAndBadInput) {
  for (const auto& [w, h] : {std::pair{1u, 1u}, {1u, 9u}, {9u, 1u}, {2u, 3u}}) {
    EXPECT_EQ(ldrFlip(randomPicture(w, h, 1), randomPicture(w, h, 2), 67).size(), size_t{w} * h);
  }
  const Picture a = randomPicture(4, 4, 1);
  EXPECT_THROW(ldrFlip(a, randomPicture(4, 5, 1), 67), InputError);
  EXPECT_THROW(ldrFlip(a, a, 0), InputError);
  EXPECT_THROW(hdrFlip(Picture{}, Picture{}, 67), InputError);
}

TEST(Flip, PixelsPerDegreeOfTheDefaultScreen) {
  EXPECT_NEAR(pixelsPerDegree(0.7, 0.7, 3840), 67.02, 0.005);
  EXPECT_DOUBLE_EQ(pixelsPerDegree(0.7, 0.7, 3840), kDefaultPixelsPerDegree);
}

}  // namespace
}  // namespace weir::image
