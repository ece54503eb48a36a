#include <gtest/gtest.h>
#include <weir/core/error.h>
#include <weir/image/metrics.h>

#include <cmath>
#include <limits>

#include "image/support.h"

namespace weir::image {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

TEST(Metrics, ByHand) {
  // One pixel: a = (1, 2, 0), b = (0.5, 2, 0.1).
  const Metrics m = measure(constantPicture(1, 1, 1, 2, 0), constantPicture(1, 1, 0.5f, 2, 0.1f));
  EXPECT_NEAR(m.mse, (0.25 + 0 + 0.01) / 3, 1e-7);
  EXPECT_NEAR(m.relMse, (0.25 / 0.26 + 0 + 0.01 / 0.02) / 3, 1e-6);
  EXPECT_NEAR(m.mape, (0.5 / 0.51 + 0 + 0.1 / 0.11) / 3, 1e-6);
  EXPECT_NEAR(m.biasR, 0.5, 1e-7);
  EXPECT_NEAR(m.biasG, 0.0, 1e-7);
  EXPECT_NEAR(m.biasB, -0.1, 1e-7);
  const double ya = 0.2126 + 2 * 0.7152, yb = 0.5 * 0.2126 + 2 * 0.7152 + 0.1 * 0.0722;
  EXPECT_NEAR(m.relativeBias, (ya - yb) / yb, 1e-7);
  EXPECT_NEAR(m.relMseMedian, m.relMse, 1e-12);
  EXPECT_NEAR(m.relMseTrimmed, m.relMse, 1e-12);
  EXPECT_EQ(m.pixels, 1u);
  EXPECT_EQ(m.nonFinite, 0u);
}

TEST(Metrics, EqualPicturesDifferByNothing) {
  const Picture picture = randomPicture(40, 30, 1);
  const Metrics m = measure(picture, picture);
  for (const double v : {m.mse, m.relMse, m.relMseTrimmed, m.relMseMedian, m.mape, m.flipMean, m.flipP99, m.biasR,
                         m.biasG, m.biasB, m.relativeBias}) {
    EXPECT_EQ(v, 0.0);
  }
}

TEST(Metrics, TrimmingDropsTheWorstThousandthOnly) {
  const Picture reference = constantPicture(50, 40, 0, 0, 0);
  Picture test = constantPicture(50, 40, 0.1f, 0.1f, 0.1f);                    // every pixel: 0.01 / 0.01 = 1
  for (int c = 0; c < 3; ++c) test.at(3, 3)[c] = test.at(30, 20)[c] = 100.0f;  // 1e6 each; 2000 pixels drop 2
  const Metrics m = measure(test, reference, {.flip = false});
  EXPECT_NEAR(m.relMse, (1998 + 2e6) / 2000, 1e-2);
  EXPECT_NEAR(m.relMseTrimmed, 1.0, 1e-6);
  EXPECT_NEAR(m.relMseMedian, 1.0, 1e-6);
  EXPECT_TRUE(std::isnan(m.flipMean));
  EXPECT_TRUE(std::isnan(m.relativeBias));  // nothing to be relative to
}

TEST(Metrics, NonFinitePixelsAreCountedAndLeftOut) {
  Picture test = constantPicture(20, 20, 1, 1, 1), reference = constantPicture(20, 20, 0.5f, 0.5f, 0.5f);
  const Metrics clean = measure(test, reference);
  test.at(1, 1)[0] = kNaN;
  test.at(2, 2)[2] = kInf;
  test.at(3, 3)[3] = kNaN;  // alpha is no colour
  reference.at(2, 2)[1] = kNaN;
  reference.at(9, 9)[1] = -kInf;
  const Metrics m = measure(test, reference);
  EXPECT_EQ(m.nonFinite, 3u);
  EXPECT_EQ(m.pixels, 397u);
  EXPECT_NEAR(m.mse, clean.mse, 1e-9);
  EXPECT_NEAR(m.relMse, clean.relMse, 1e-9);
  EXPECT_TRUE(m.flipMean > 0 && m.flipMean <= 1);
  EXPECT_TRUE(std::isfinite(m.flipP99));
}

TEST(Metrics, NothingFiniteIsNotZeroError) {
  const Metrics m = measure(constantPicture(2, 2, kNaN, 0, 0), constantPicture(2, 2, 1, 1, 1));
  EXPECT_EQ(m.nonFinite, 4u);
  EXPECT_EQ(m.pixels, 0u);
  EXPECT_TRUE(std::isnan(m.mse) && std::isnan(m.relMseMedian) && std::isnan(m.relMseTrimmed) && std::isnan(m.flipP99));
}

TEST(Metrics, MaskSelectsPixels) {
  Picture test = constantPicture(4, 4, 0, 0, 0), mask = test;
  const Picture reference = test;
  test.at(0, 0)[0] = 3.0f;
  test.at(1, 0)[0] = kNaN;
  mask.at(0, 0)[1] = 1.0f;
  mask.at(2, 2)[0] = 1.0f;
  mask.at(3, 3)[0] = 0.5f;  // not above 0.5
  mask.at(3, 2)[0] = kNaN;  // nor is this
  const Metrics m = measure(test, reference, {.mask = &mask});
  EXPECT_EQ(m.pixels, 2u);
  EXPECT_EQ(m.nonFinite, 0u);
  EXPECT_NEAR(m.mse, 9.0 / 6, 1e-9);
  const Picture nothing = constantPicture(4, 4, 0, 0, 0), small = constantPicture(3, 4, 1, 1, 1);
  expectInputError([&] { measure(test, reference, {.mask = &nothing}); }, {"mask", "no pixel"});
  expectInputError([&] { measure(test, reference, {.mask = &small}); }, {"mask", "3x4", "4x4"});
  expectInputError([&] { measure(small, reference); }, {"3x4", "4x4"});
}

TEST(Metrics, TilesByHand) {
  // 5x3 in tiles of 2: 3 columns, 2 rows; the right column is 1 wide, the bottom row 1 high.
  Picture test = constantPicture(5, 3, 1, 1, 1);
  const Picture reference = test;
  for (int c = 0; c < 3; ++c) {
    test.at(0, 0)[c] = 1.4f;  // one of four pixels: +0.1
    test.at(4, 2)[c] = 0.5f;  // a tile of one pixel: -0.5
  }
  const TileSummary s = compareTiles(test, reference, 2);
  ASSERT_EQ(s.tiles.size(), 6u);
  EXPECT_NEAR(s.tiles[0].difference, 0.1, 1e-7);
  EXPECT_NEAR(s.tiles[0].differenceB, 0.1, 1e-7);
  EXPECT_NEAR(s.tiles[5].relative, -0.5, 1e-7);
  EXPECT_EQ(s.tiles[5].x, 4u);
  EXPECT_EQ(s.tiles[5].y, 2u);
  EXPECT_EQ(s.tiles[5].pixels, 1u);
  EXPECT_NEAR(s.maxRelative, 0.5, 1e-7);
  EXPECT_NEAR(s.rmsRelative, std::sqrt((0.01 + 0.25) / 6), 1e-7);
  ASSERT_EQ(s.worst.size(), 5u);
  EXPECT_EQ(s.worst[0], 5u);
  EXPECT_EQ(s.worst[1], 0u);
  EXPECT_THROW(compareTiles(test, reference, 0), InputError);
}

TEST(Metrics, BlackTilesDoNotDominate) {
  Picture reference = constantPicture(4, 2, 1, 1, 1);
  for (uint32_t i = 0; i < 4; ++i) std::fill_n(reference.at(2 + i % 2, i / 2), 3, 0.0f);
  Picture test = reference;
  for (int c = 0; c < 3; ++c) test.at(2, 0)[c] = 4e-4f;  // 1e-4 over the tile; the floor is 0.01 · 0.5
  const TileSummary s = compareTiles(test, reference, 2);
  EXPECT_NEAR(s.tiles[1].relative, 1e-4 / 0.005, 1e-6);
}

TEST(Metrics, AttributesThatNameOtherThings) {
  Picture a, b;
  a.attributes = {{"weir.scene", "box"}, {"weir.camera", "front"}, {"weir.seed", "1"}, {"weir.lights", "7"}};
  b.attributes = {{"weir.scene", "ball"}, {"weir.camera", "front"}, {"weir.seed", "2"}};
  const std::vector<std::string> conflicts = attributeConflicts(a, b);
  ASSERT_EQ(conflicts.size(), 1u);  // seeds may differ, and lights are not in both
  EXPECT_EQ(conflicts[0], "weir.scene: 'box' here, 'ball' in the reference");
  EXPECT_TRUE(attributeConflicts(a, a).empty());
  b = a;
  a.attributes["weir.shading"] = "glTF 2.0";
  EXPECT_TRUE(attributeConflicts(a, b).empty()) << "one of them doesn't say";
  b.attributes["weir.shading"] = "glTF 2.0 with energy compensation";
  EXPECT_EQ(attributeConflicts(a, b).size(), 1u);
}

TEST(Metrics, NothingIsRelativeToBlackOrNegative) {
  for (const float b : {0.0f, -1.0f}) {
    const Picture reference = constantPicture(16, 8, b, b, b);
    Picture test = reference;
    test.at(9, 1)[0] += 1.0f;
    EXPECT_TRUE(std::isnan(measure(test, reference, {.flip = false}).relativeBias));
    const TileSummary s = compareTiles(test, reference, 8);
    EXPECT_EQ(s.tiles[0].relative, 0.0);
    EXPECT_TRUE(std::isnan(s.tiles[1].relative));
    EXPECT_TRUE(std::isnan(s.rmsRelative));
    EXPECT_TRUE(std::isnan(s.maxRelative));
    EXPECT_EQ(s.worst, (std::vector<size_t>{1, 0}));
  }
}

}  // namespace
}  // namespace weir::image
