// What is known of the mean of every tile of a picture, and how well: from independent restarts, or from a picture with
// its standard error. verdict.h compares two of these.
//
// Three scales at once: the whole picture, coarse tiles and fine tiles. Means of many pixels resolve small biases,
// small tiles say where they are.
#pragma once

#include <weir/image/image.h>
#include <weir/image/statistics.h>
#include <weir/image/tiles.h>

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace weir::image {

/// Mean and sums of powers of deviations up to the fourth, in double (Pébay 2008, "Formulas for Robust, One-Pass
/// Parallel Computation of Covariances and Arbitrary-Order Statistical Moments", eqs. 2.1, 2.6 to 2.9 for one value).
struct ShapeMoments {
  double mean = 0, second = 0, third = 0, fourth = 0;
  void add(double value, uint64_t countWithIt);
};

/// A mean and what is known of its error.
struct Estimate {
  double mean = 0;
  double variance = 0;  ///< of the mean; infinite where nothing is known
  /// Degrees of freedom of that variance: how well it is known itself. Infinite where it is given, or none.
  double freedom = std::numeric_limits<double>::infinity();
  double cumulant = 0;  ///< third cumulant of the mean: its skewness times variance^1.5
  double excess = 0;    ///< excess kurtosis of a restart, 0 at least, where it is known
  uint64_t count = 0;   ///< restarts behind the mean; 0: none, or unknown
};

/// Of a mean over `count` independent values. The variance of a sample of heavy tails is itself known badly:
///   Var(s²) = σ⁴ (2 / (n - 1) + excess kurtosis / n)
/// (Cramér 1946, 27.4), and freedom is that of the χ² with the same relative variance, 2 / (Var(s²) / σ⁴). So
/// n - 1 for a sample that looks normal, and about 2 where one value out of n makes all of the variance: one firefly in
/// 64 restarts says little about how bright fireflies are. Excess kurtosis below 0 counts as 0.
Estimate estimate(const ShapeMoments& moments, uint64_t count);

using ColourEstimates = std::array<Estimate, 4>;  ///< R, G, B, luminance

struct Evidence {
  TileGrid fine, coarse;
  std::vector<ColourEstimates> fineTiles, coarseTiles;  ///< row by row
  ColourEstimates whole{};
  uint64_t restarts = 0;  ///< that it comes from; 0: a picture
};

/// Where a picture was not finite.
struct NonFinite {
  uint64_t pixels = 0;  ///< summed over restarts
  uint32_t x = 0, y = 0;
  uint64_t restart = 0;  ///< of the first one
};
NonFinite findNonFinite(const Picture& picture);

/// Light is not negative: a reference whose mean is below 0, of a tile or of the whole picture in any colour, is an
/// InputError that says where.
void requireNotNegative(const Evidence& reference, const std::string& name);

/// Collects restarts: one picture each, which may itself be the mean of its frames. Memory: 64 bytes a pixel.
class EvidenceCollector {
 public:
  /// Sides in pixels. Throws InputError unless coarse is a multiple of fine.
  EvidenceCollector(uint32_t fineSide, uint32_t coarseSide);
  /// Throws InputError if its size differs from the first one's.
  void add(const Picture& picture) { add(std::span(&picture, 1)); }
  /// Several, as if one after the other, on several cores. All or, when it throws, none.
  void add(std::span<const Picture> pictures);
  uint64_t restarts() const { return pixels_.restarts(); }
  const NonFinite& nonFinite() const { return nonFinite_; }
  Picture mean() const { return pixels_.mean(); }
  Picture standardError() const { return pixels_.standardError(); }
  Evidence evidence() const;

 private:
  using Shapes = std::array<ShapeMoments, 4>;
  TileGrid fine_, coarse_;
  RestartAccumulator pixels_;
  std::vector<Shapes> fineShapes_, coarseShapes_;
  Shapes wholeShapes_{};
  NonFinite nonFinite_;
};

/// A picture that has no error.
Evidence exactEvidence(const Picture& picture, uint32_t fineSide, uint32_t coarseSide);

/// A mean over `restarts` independent pictures, of which only it and its pixels' standard error are left. Pixels are
/// taken as independent (a brute-force reference's are; a picture with spatial reuse is no reference), colours as fully
/// correlated, which overstates the error of luminance. Freedom of a tile's variance by Satterthwaite 1946 from
/// restarts - 1 for each pixel. A pixel offset that a whole frame shares (jitter) makes all of its pixels dependent:
/// not for such pictures. Throws InputError for sizes that differ, or an error that is negative or not finite.
Evidence pictureEvidence(const Picture& picture, const Picture& error, uint64_t restarts, uint32_t fineSide,
                         uint32_t coarseSide);

/// A picture of unknown error: how its pixels scatter about `other` (the mean of what is tested) bounds it. Within each
/// tile the variance of picture - other, divided by the number of pixels, is taken as the variance of the tile's mean.
/// That counts the other's noise a second time, and any bias that changes from pixel to pixel as noise: too large
/// rather than too small, as long as the picture's pixels are independent, which they aren't under a shared offset.
Evidence scatterEvidence(const Picture& picture, const Picture& other, uint32_t fineSide, uint32_t coarseSide);

}  // namespace weir::image
