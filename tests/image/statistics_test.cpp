#include <gtest/gtest.h>
#include <weir/core/error.h>
#include <weir/image/evidence.h>
#include <weir/image/statistics.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <mutex>
#include <set>
#include <span>
#include <utility>

#include "image/support.h"

namespace weir::image {
namespace {

TEST(Restarts, MeanAndStandardErrorByHand) {
  RestartAccumulator restarts(2);
  for (const float v : {1.0f, 2.0f, 6.0f}) restarts.add(constantPicture(3, 3, v, 2 * v, 0.5f));
  EXPECT_EQ(restarts.restarts(), 3u);
  const Picture mean = restarts.mean(), error = restarts.standardError();
  EXPECT_FLOAT_EQ(mean.at(2, 1)[0], 3.0f);
  EXPECT_FLOAT_EQ(mean.at(2, 1)[1], 6.0f);
  // Deviations -2, -1, 3: variance 14/2, error sqrt(7/3).
  EXPECT_FLOAT_EQ(error.at(0, 0)[0], std::sqrt(7.0f / 3.0f));
  EXPECT_FLOAT_EQ(error.at(0, 0)[2], 0.0f);
  const TileStatistics& tiles = restarts.tiles();
  ASSERT_EQ(tiles.tiles.size(), 4u);  // 2x2, 1x2, 2x1 and 1x1 pixels
  for (const ColourMoments& tile : tiles.tiles) {
    EXPECT_NEAR(tile[1].mean, 6.0, 1e-12);
    EXPECT_NEAR(tile[1].standardError(3), 2 * std::sqrt(7.0 / 3.0), 1e-12);
    EXPECT_NEAR(tile[kLuminance].mean, 0.2126 * 3 + 0.7152 * 6 + 0.0722 * 0.5, 1e-12);
  }
}

TEST(Restarts, ATileIsOneSampleARestart) {
  // Two pixels that always cancel: each varies, their mean does not.
  RestartAccumulator restarts(2);
  for (const float v : {0.0f, 1.0f, 0.5f}) {
    Picture picture = constantPicture(2, 1, v, v, v);
    for (int c = 0; c < 3; ++c) picture.at(1, 0)[c] = 1 - v;
    restarts.add(picture);
  }
  EXPECT_GT(restarts.standardError().at(0, 0)[0], 0.2f);
  EXPECT_NEAR(restarts.tiles().tiles[0][0].standardError(3), 0.0, 1e-15);
}

TEST(Restarts, MergingEqualsAdding) {
  RestartAccumulator all(8), first(8), second(8), none(8);
  for (uint32_t i = 0; i < 7; ++i) {
    const Picture picture = randomPicture(19, 11, i);
    all.add(picture);
    (i < 3 ? first : second).add(picture);
  }
  first.merge(none);
  none.merge(first);
  none.merge(second);
  EXPECT_EQ(none.restarts(), 7u);
  const Picture a = all.standardError(), b = none.standardError(), c = all.mean(), d = none.mean();
  for (size_t i = 0; i < a.rgba.size(); ++i) {
    ASSERT_NEAR(a.rgba[i], b.rgba[i], 1e-6);
    ASSERT_NEAR(c.rgba[i], d.rgba[i], 1e-6);
  }
  EXPECT_NEAR(all.tiles().whole[kLuminance].squares, none.tiles().whole[kLuminance].squares, 1e-12);
  EXPECT_THROW(none.merge([] {
    RestartAccumulator other(4);
    other.add(randomPicture(19, 11, 1));
    return other;
  }()),
               InputError);
  EXPECT_THROW(none.add(randomPicture(11, 19, 1)), InputError);
  EXPECT_THROW(RestartAccumulator(8).mean(), InputError);
}

// Of pictures that are large enough to be cut into bands, with a last row of tiles that is not whole.
TEST(Restarts, AddedTogetherAreThoseAddedOneByOne) {
  std::vector<Picture> pictures;
  for (uint32_t i = 0; i < 6; ++i) pictures.push_back(randomPicture(301, 203, i));
  pictures[4].at(7, 150)[1] = std::numeric_limits<float>::quiet_NaN();
  pictures[5].at(6, 3)[2] = std::numeric_limits<float>::infinity();
  EvidenceCollector single(16, 64), together(16, 64);
  for (const Picture& picture : pictures) single.add(picture);
  together.add(std::span(pictures).first(2));
  together.add(std::span<const Picture>{});
  together.add(std::span(pictures).subspan(2));
  EXPECT_EQ(together.restarts(), 6u);
  EXPECT_EQ(together.nonFinite().pixels, 2u);
  EXPECT_EQ(together.nonFinite().x, 7u);
  EXPECT_EQ(together.nonFinite().y, 150u);
  EXPECT_EQ(together.nonFinite().restart, 4u);
  const auto bits = [](float v) { return std::bit_cast<uint32_t>(v); };
  for (const auto& [a, b] :
       {std::pair(single.mean(), together.mean()), std::pair(single.standardError(), together.standardError())})
    EXPECT_TRUE(std::ranges::equal(a.rgba, b.rgba, {}, bits, bits));
  const Evidence one = single.evidence(), all = together.evidence();
  const auto same = [](const ColourEstimates& a, const ColourEstimates& b) {
    return std::ranges::equal(a, b, [](const Estimate& x, const Estimate& y) {
      return std::bit_cast<uint64_t>(x.mean) == std::bit_cast<uint64_t>(y.mean) && x.variance == y.variance &&
             x.freedom == y.freedom && x.cumulant == y.cumulant;
    });
  };
  EXPECT_TRUE(std::ranges::equal(one.fineTiles, all.fineTiles, same));
  EXPECT_TRUE(std::ranges::equal(one.coarseTiles, all.coarseTiles, same));
  EXPECT_TRUE(same(one.whole, all.whole));
  pictures[5] = randomPicture(203, 301, 5);
  EXPECT_THROW(together.add(pictures), InputError);
  EXPECT_EQ(together.restarts(), 6u) << "all or none";
}

TEST(Bands, AreWholeRowsOfTilesAndTogetherThePicture) {
  for (const TileGrid grid : {TileGrid{1000, 1001, 16}, TileGrid{5, 5, 64}, TileGrid{4000, 3, 1}, TileGrid{1, 1, 1}}) {
    std::mutex mutex;
    std::set<std::pair<uint32_t, uint32_t>> bands;
    forBands(grid, 3, [&](uint32_t first, uint32_t end) {
      const std::lock_guard lock(mutex);
      bands.emplace(first, end);
    });
    uint32_t at = 0;
    for (const auto& [first, end] : bands) {
      EXPECT_EQ(first, at);
      EXPECT_GT(end, first);
      EXPECT_TRUE(first % grid.side == 0 && (end % grid.side == 0 || end == grid.height));
      at = end;
    }
    EXPECT_EQ(at, grid.height);
  }
  forBands({0, 0, 16}, 1, [](uint32_t, uint32_t) { ADD_FAILURE() << "there is nothing"; });
}

/// Restarts of an estimator that is right but for a relative bias: every tile mean is normal with relative
/// standard deviation `spread`, a different brightness for every tile, and noise that pixels of a tile share in part.
struct Synthetic {
  static constexpr uint32_t kSide = 4;
  uint32_t width, height;
  double spread;
  std::mt19937_64 random;

  double truth(uint32_t x, uint32_t y) const { return 0.1 + 0.05 * double((x / kSide + 3 * (y / kSide)) % 11); }

  Picture reference() const {
    Picture picture = constantPicture(width, height, 0, 0, 0);
    for (uint32_t y = 0; y < height; ++y) {
      for (uint32_t x = 0; x < width; ++x) {
        for (int c = 0; c < 3; ++c) picture.at(x, y)[c] = float(truth(x, y));
      }
    }
    return picture;
  }

  /// `bias` is relative; on the tile number `biasedTile` alone, or on all if that is negative.
  Picture restart(double bias, int biasedTile = -1) {
    std::normal_distribution<double> normal;
    Picture picture = reference();
    const TileGrid grid{width, height, kSide};
    std::vector<double> factors(grid.count());
    for (size_t i = 0; i < factors.size(); ++i) {
      const bool biased = biasedTile < 0 || i == size_t(biasedTile);
      factors[i] = 1 + spread * normal(random) + (biased ? bias : 0.0);
    }
    for (uint32_t y = 0; y < height; ++y) {
      for (uint32_t x = 0; x < width; ++x) {
        for (int c = 0; c < 3; ++c) picture.at(x, y)[c] *= float(factors[grid.index(x, y)]);
      }
    }
    return picture;
  }

  TileTest test(int restarts, double bias, int biasedTile = -1) {
    RestartAccumulator accumulator(kSide);
    for (int i = 0; i < restarts; ++i) accumulator.add(restart(bias, biasedTile));
    return tileTest(accumulator.tiles(), reference());
  }
};

TEST(TileTest, FalseAlarmsAreAsRareAsAsked) {
  // 1000 unbiased pictures of 60 tiles, 16 restarts each, alpha = 0.01: 10 alarms are expected, and 1 to 24 have a
  // probability of 0.99996 (binomial). Seen with this seed: in the message.
  Synthetic synthetic{40, 24, 0.02, std::mt19937_64(7)};
  int alarms = 0, outside = 0;
  for (int i = 0; i < 1000; ++i) {
    const TileTest test = synthetic.test(16, 0.0);
    alarms += !test.passed;
    outside += test.intervalLow > 0 || test.intervalHigh < 0;
  }
  std::printf("false alarms: %d of 1000 pictures, interval missed %d times; 10 expected of each\n", alarms, outside);
  EXPECT_GE(alarms, 1);
  EXPECT_LE(alarms, 24);
  EXPECT_GE(outside, 1);
  EXPECT_LE(outside, 24);
}

TEST(TileTest, FindsHalfAPercent) {
  // 64 restarts with 0.5 % spread a tile: a bias of 0.5 % is eight standard errors of a tile's mean.
  Synthetic synthetic{40, 24, 0.005, std::mt19937_64(8)};
  for (int i = 0; i < 100; ++i) {
    const TileTest everywhere = synthetic.test(64, 0.005);
    EXPECT_FALSE(everywhere.passed);
    EXPECT_GT(everywhere.intervalLow, 0.0);
    EXPECT_NEAR(everywhere.relativeBias, 0.005, 0.0005);
    const TileTest one = synthetic.test(64, 0.005, 17);
    EXPECT_FALSE(one.passed);
    EXPECT_EQ(one.worst, 17u);
    EXPECT_LT(one.detectable, 0.005);
  }
}

TEST(TileTest, DetectableSaysWhatIsFoundHalfOfTheTime) {
  Synthetic synthetic{40, 24, 0.02, std::mt19937_64(9)};
  const double size = synthetic.test(64, 0.0).detectable;
  int found = 0;
  for (int i = 0; i < 200; ++i) found += !synthetic.test(64, size, 5).passed;
  EXPECT_GT(found, 60);
  EXPECT_LT(found, 140);
}

TEST(TileTest, TheReferencesOwnErrorIsCounted) {
  // A reference that is off by noise its standard error admits: without that error it looks biased.
  Synthetic synthetic{40, 24, 0.001, std::mt19937_64(10)};
  RestartAccumulator accumulator(Synthetic::kSide);
  for (int i = 0; i < 64; ++i) accumulator.add(synthetic.restart(0.0));
  Picture reference = synthetic.reference(), error = reference;
  std::normal_distribution<double> normal;
  for (size_t i = 0; i < reference.rgba.size(); i += 4) {
    const double offset = 0.01 * normal(synthetic.random);
    for (size_t c = 0; c < 3; ++c) {
      reference.rgba[i + c] += float(offset);
      error.rgba[i + c] = 0.01f;
    }
  }
  EXPECT_FALSE(tileTest(accumulator.tiles(), reference).passed);
  const TileTest test = tileTest(accumulator.tiles(), reference, &error);
  EXPECT_TRUE(test.passed) << test.worstT;
  // 16 pixels of 0.01 each: 0.0025 a tile, far above the restarts' own.
  EXPECT_NEAR(test.tiles[0].standardError, 0.0025, 1e-5);
}

TEST(TileTest, TilesThatDoNotVary) {
  const std::vector<Picture> restarts(5, constantPicture(8, 8, 0.1f, 0.2f, 0.3f));
  EXPECT_TRUE(tileTest(restarts, constantPicture(8, 8, 0.1f, 0.2f, 0.3f), 4).passed);
  EXPECT_FALSE(tileTest(restarts, constantPicture(8, 8, 0.1f, 0.2001f, 0.3f), 4).passed);
  const std::vector<Picture> black(5, constantPicture(8, 8, 0, 0, 0));
  const TileTest test = tileTest(black, constantPicture(8, 8, 0, 0, 0), 4);
  EXPECT_TRUE(test.passed);
  EXPECT_EQ(test.relativeBias, 0.0);
  EXPECT_FALSE(tileTest(black, constantPicture(8, 8, 0, 1e-6f, 0), 4).passed);
}

TEST(TileTest, AColourShiftThatKeepsLuminanceNeedsEachColour) {
  std::vector<Picture> restarts;
  std::mt19937 random(3);
  for (int i = 0; i < 16; ++i) {
    const float noise = 0.001f * float(random()) * 0x1p-32f;
    restarts.push_back(
        constantPicture(8, 8, 0.5f + 0.05f + noise, 0.5f + noise, 0.5f - 0.05f * 0.2126f / 0.0722f + noise));
  }
  const Picture reference = constantPicture(8, 8, 0.5005f, 0.5005f, 0.5005f);
  EXPECT_TRUE(tileTest(restarts, reference, 4).passed);
  const TileTest each = tileTest(restarts, reference, 4, nullptr, {.eachColour = true});
  EXPECT_EQ(each.comparisons, 12);
  EXPECT_FALSE(each.passed);
}

TEST(TileTest, NonFiniteNeverPasses) {
  std::vector<Picture> restarts;
  for (uint32_t i = 0; i < 4; ++i) restarts.push_back(randomPicture(8, 8, i));
  restarts[2].at(5, 1)[1] = std::numeric_limits<float>::quiet_NaN();
  RestartAccumulator accumulator(4);
  for (const Picture& picture : restarts) accumulator.add(picture);
  EXPECT_EQ(accumulator.nonFinite(), 1u);
  const TileTest test = tileTest(accumulator.tiles(), randomPicture(8, 8, 9));
  EXPECT_FALSE(test.passed);
  EXPECT_EQ(test.worst, 1u);
  EXPECT_THROW(tileTest({restarts[0]}, restarts[0], 4), InputError);
  EXPECT_THROW(tileTest(restarts, randomPicture(8, 9, 1), 4), InputError);
}

}  // namespace
}  // namespace weir::image
