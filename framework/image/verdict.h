// Is an estimator unbiased? A verdict from independent restarts against a reference: unbiased to so many percent,
// biased, or undecided. docs/verify.md has the reasoning.
//
// Three questions share one chance of a false alarm, alpha:
//   - the whole picture's luminance (half of alpha): a wide net for a bias that is the same everywhere;
//   - the colours of the picture and of its coarse tiles (a quarter): power against biases of a region;
//   - the colours of the fine tiles (a quarter): where.
// Within a question the bound is Šidák's over all of its comparisons, between questions the shares add up (Bonferroni),
// so that whatever the dependence between comparisons, an unbiased estimator is called biased with probability alpha at
// most, as far as a t test with the variances' own uncertainty and skewness taken in holds alpha for one comparison.
// It does for light that both sides have seen often. Light that comes in huge events, so rare that one side has seen
// none or next to none of them, is beyond what any sample can tell from bias; equal numbers of restarts keep such cases
// symmetric, and spreadRareEvents (verdict.cpp) counts them where the numbers differ.
#pragma once

#include <weir/image/evidence.h>

#include <string>
#include <vector>

namespace weir::image {

struct VerdictOptions {
  double alpha = 0.01;       ///< chance of a false alarm over all looks and all comparisons (see above for what limits)
  double tolerance = 0.005;  ///< relative; "unbiased" says that the whole picture is right to at least this
  /// Relative; "unbiased" says of coarse tiles that half of those that vary are known to at least this.
  double tileTolerance = 0.05;
  double negligible = 1e-5;  ///< relative differences up to this are rounding, not bias
  uint64_t fewest = 16;      ///< restarts below which nothing is decided: the t test leans on means being near normal
  /// How many verdicts are asked for of growing evidence. Each gets alpha / looks, as looking until one of them alarms
  /// would otherwise alarm more often than alpha.
  int looks = 1;
};

/// A tile's mean against the reference's: Welch's t (Welch 1947) with Hall's removal of skewness (Hall 1992). Between
/// unlike numbers of restarts of which the fewer may have missed rare events, the pooled variance if it is larger.
struct Comparison {
  double mean = 0, reference = 0;
  double standardError = 0;  ///< of the difference
  double freedom = 0;        ///< Welch-Satterthwaite, of variances that heavy tails make less certain (evidence.h)
  double t =
      0;  ///< beyond the negligible; the smaller one of plain and of skewness-corrected t; 0 where both are equal
  double p = 1;         ///< two-sided
  double relative = 0;  ///< (mean - reference) / reference; 0 where both are 0, infinite on a black reference
};
Comparison compare(const Estimate& measured, const Estimate& reference, double negligible);

/// The |t| that is exceeded with probability `level`; remembers what it has worked out. Freedom is rounded down, and
/// from 10^6 on it is infinite for all purposes.
double criticalT(double freedom, double level);

/// One scale of tiles, or the whole picture.
struct Scale {
  TileGrid grid;
  double level = 0;  ///< p below which a comparison alarms
  size_t comparisons = 0;
  std::vector<Comparison> tiles;  ///< row by row: of the colour with the smallest p
  std::vector<char> colours;      ///< 'R', 'G', 'B' or 'Y' (luminance)
  size_t worst = 0;               ///< the tile with the smallest p
  std::vector<size_t> alarms;     ///< tiles with p < level, worst first
  /// Relative bias that would be found half of the time in one tile alone: median over tiles that are lit and vary.
  /// 0 where none varies, infinite on a black reference.
  double resolution = 0;
};

enum class Answer : unsigned char { Unbiased, Biased, Undecided };
const char* answerName(Answer answer);

struct Verdict {
  Answer answer = Answer::Undecided;
  std::vector<std::string> reasons;  ///< sentences: what speaks for it
  uint64_t restarts = 0, referenceRestarts = 0;
  double alpha = 0;          ///< of this look
  Comparison whole;          ///< luminance
  double low = 0, high = 0;  ///< interval of the whole picture's relative bias at the level that it is tested at
  double wholeLevel = 0;     ///< 1 - confidence of that interval
  double within = 0;         ///< max(|low|, |high|): "unbiased to this"
  Scale coarse, fine;        ///< coarse.tiles has the whole picture's colours behind the tiles
  /// Restarts that should decide an undecided case, if nothing is wrong; 0 where no number of them can, or none is
  /// needed.
  uint64_t enough = 0;
};

/// `measured` must come from restarts. Sizes and tile sides must agree (InputError). `bad`: non-finite pixels that the
/// restarts had, which is biased whatever else. A black reference is undecided.
Verdict decide(const Evidence& measured, const Evidence& reference, const NonFinite& bad,
               const VerdictOptions& options = {});

}  // namespace weir::image
