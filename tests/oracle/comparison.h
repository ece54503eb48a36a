// Do two pictures with known errors show the same? Per tile, and as a whole.
#pragma once

#include <weir/image/statistics.h>

#include <string>

namespace weir::oracle {

struct Verdict {
  uint32_t tiles = 0;
  double bound = 0;        ///< of |t|, all tiles together at 1 %
  double worstT = 0;       ///< largest |t| of a tile where something varies, whatever is tolerated
  double worstExcess = 0;  ///< largest |difference| over what is allowed; passed: at most 1
  double worstRelative = 0;
  uint32_t left = 0, top = 0;          ///< pixel of the tile with the largest excess
  double bias = 0, low = 0, high = 0;  ///< of the whole picture's luminance, relative, 99 %
  double detectable = 0;               ///< median over lit tiles of (bound · error + tolerance) / reference
  bool passed = false;
  std::string text() const;
};

/// A tile passes where |mean - reference| <= bound · standard error + tolerance · reference. `tolerance`, relative:
/// what the device's number formats may change (see agreement_test.cpp); 0 for a pure t test.
Verdict compare(const image::TileTest& test, double tolerance);

/// The same for pictures whose errors are known pixel by pixel alone, all pixels taken as independent: so for brute
/// force without `jitter`, not for reuse. Throws InputError for other sizes.
Verdict compare(const image::Picture& picture, const image::Picture& error, const image::Picture& reference,
                const image::Picture& referenceError, uint32_t tile, double tolerance);

}  // namespace weir::oracle
