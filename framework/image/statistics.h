// What independent restarts say about an estimator: means, standard errors, and a test against a reference.
//
// The unit of every statistic here is the restart. Frames of one sequence with temporal reuse are correlated, pixels of
// one frame with spatial reuse are too; only sequences that began with cleared history and their own seed are
// independent. So add() takes ONE picture a restart (which may itself be the mean of that restart's frames), and a
// tile's standard error comes from how its mean varies between restarts, never from its pixels.
#pragma once

#include <weir/image/image.h>
#include <weir/image/student.h>
#include <weir/image/tiles.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace weir::image {

/// Running mean and sum of squared deviations (Welford 1962; merging: Chan, Golub & LeVeque 1979), in double.
struct Moments {
  double mean = 0.0, squares = 0.0;
  void add(double value, uint64_t countWithIt);
  void merge(const Moments& other, uint64_t count, uint64_t otherCount);
  /// sqrt(sum of squares / (n (n - 1))): the standard error of the mean; infinite for fewer than two.
  double standardError(uint64_t count) const;
};

/// R, G, B and luminance of one tile's mean.
using ColourMoments = std::array<Moments, 4>;
constexpr size_t kLuminance = 3;

/// Per-tile statistics over restarts.
struct TileStatistics {
  TileGrid grid;
  uint64_t restarts = 0;
  std::vector<ColourMoments> tiles;  ///< grid.count(), row by row
  ColourMoments whole{};             ///< of the whole picture's mean
};

/// Collects restarts. Memory: 64 bytes a pixel, whatever their number.
/// A non-finite value is not left out: it makes its pixel's and tile's mean non-finite, which tileTest() rejects.
class RestartAccumulator {
 public:
  /// `tileSide` in pixels. Throws InputError if it is 0.
  explicit RestartAccumulator(uint32_t tileSide = 64);

  /// One independent restart. Throws InputError if its size differs from the first one's.
  void add(const Picture& picture) { add(std::span(&picture, 1)); }
  /// Several, as if one after the other, on several cores. All or, when it throws, none.
  void add(std::span<const Picture> pictures);
  /// As if the other's restarts had been added here. Throws InputError for another size or tile side.
  void merge(const RestartAccumulator& other);

  uint64_t restarts() const { return tiles_.restarts; }
  uint64_t nonFinite() const { return nonFinite_; }  ///< pixels with a non-finite colour, summed over restarts

  /// RGBA mean over restarts, without attributes. Throws InputError before the first restart.
  Picture mean() const;
  /// RGBA standard error of that mean; infinite after a single restart.
  Picture standardError() const;
  const TileStatistics& tiles() const { return tiles_; }

 private:
  std::vector<Moments> pixels_;  ///< 4 · width · height
  TileStatistics tiles_;
  uint64_t nonFinite_ = 0;
};

struct TileTestOptions {
  double alpha = 0.01;      ///< chance of a false alarm in the whole picture, not in a tile
  bool eachColour = false;  ///< tests R, G and B of every tile (3 comparisons each) instead of its luminance
};

struct TileResult {
  double mean = 0, reference = 0;  ///< luminance, or of the colour with the largest |t|
  double standardError = 0;        ///< sqrt(of the restarts² + of the reference²)
  double t = 0;                    ///< (mean - reference) / standardError
  double relativeBias = 0;  ///< (mean - reference) / reference; 0 where both are 0, infinite on a black reference
};

struct TileTest {
  TileGrid grid;
  uint64_t restarts = 0;
  int comparisons = 0;
  double bound = 0;               ///< studentTBound(restarts - 1, alpha, comparisons)
  std::vector<TileResult> tiles;  ///< row by row
  size_t worst = 0;               ///< the tile with the largest |t|
  double worstT = 0;              ///< its |t|; infinite where a figure is not finite
  bool passed = false;            ///< worstT <= bound
  /// (mean - reference) / reference of the whole picture's luminance, and its two-sided interval at 1 - alpha.
  double relativeBias = 0, intervalLow = 0, intervalHigh = 0;
  /// Median over tiles of bound · standardError / reference: a relative bias of this size in one such tile alone is
  /// found half of the time. A test that passed says "unbiased to about this", and no more.
  double detectable = 0;
};

/// Is the mean over restarts the reference? Per tile, t with restarts - 1 degrees of freedom against a Šidák bound over
/// all comparisons. `referenceError`: standard error of each pixel of the reference, or null for an exact one. Its
/// pixels are taken as independent (a brute-force reference's are); its colours as fully correlated, which overstates
/// the error of luminance, that is, errs on the side of silence. Degrees of freedom stay restarts - 1 although the
/// reference adds some: on the same side.
/// A tile where nothing varies (black, or emission seen directly) passes if mean and reference agree to 1e-6 relative:
/// rounding to float is no bias.
/// Assumes that tile means are near enough normal: restarts of few samples with fireflies have fewer false
/// alarms than alpha, and less power.
/// Throws InputError for fewer than two restarts or other sizes.
TileTest tileTest(const TileStatistics& measured, const Picture& reference, const Picture* referenceError = nullptr,
                  const TileTestOptions& options = {});
/// The same from the restarts' pictures.
TileTest tileTest(const std::vector<Picture>& restarts, const Picture& reference, uint32_t tileSide,
                  const Picture* referenceError = nullptr, const TileTestOptions& options = {});

}  // namespace weir::image
