#include "comparison.h"

#include <fmt/format.h>
#include <weir/core/error.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace weir::oracle {
namespace {

/// Floats on one side, doubles on the other.
constexpr double kRounding = 1e-5;

struct TileSums {
  double mean = 0, reference = 0, variance = 0;
  uint32_t pixels = 0;
};

}  // namespace

std::string Verdict::text() const {
  return fmt::format(
      "worst |t| {:.2f} of {} tiles (bound {:.2f})  worst tile {:+.3f} % at {}, {} ({:.2f} of what is allowed)  mean "
      "bias "
      "{:+.4f} % (99 %: {:+.4f} … {:+.4f})  a tile to {:.2f} %  {}",
      worstT, tiles, bound, 100 * worstRelative, left, top, worstExcess, 100 * bias, 100 * low, 100 * high,
      100 * detectable, passed ? "agree" : "DIFFER");
}

Verdict compare(const image::TileTest& test, double tolerance) {
  Verdict v;
  v.tiles = static_cast<uint32_t>(test.tiles.size());
  v.bound = test.bound;
  if (std::isfinite(test.intervalLow)) {  // it isn't where the reference is black
    v.bias = test.relativeBias;
    v.low = test.intervalLow;
    v.high = test.intervalHigh;
  }
  std::vector<double> resolved;
  bool finite = true;
  for (size_t i = 0; i < test.tiles.size(); ++i) {
    const image::TileResult& tile = test.tiles[i];
    const double difference = std::abs(tile.mean - tile.reference), reference = std::abs(tile.reference);
    const double allowed = test.bound * tile.standardError + (tolerance + kRounding) * reference;
    finite = finite && std::isfinite(tile.mean) && std::isfinite(allowed);
    if (tile.standardError > kRounding * reference) v.worstT = std::max(v.worstT, difference / tile.standardError);
    const double excess = difference <= 0 ? 0.0
                          : allowed > 0   ? difference / allowed
                                          : std::numeric_limits<double>::infinity();
    if (excess > v.worstExcess) {
      v.worstExcess = excess;
      v.worstRelative = tile.relativeBias;
      v.left = test.grid.left(i);
      v.top = test.grid.top(i);
    }
    if (reference > 0) resolved.push_back(allowed / reference);
  }
  if (!resolved.empty()) {
    std::ranges::nth_element(resolved, resolved.begin() + static_cast<std::ptrdiff_t>(resolved.size() / 2));
    v.detectable = resolved[resolved.size() / 2];
  }
  v.passed = finite && v.worstExcess <= 1.0;
  return v;
}

Verdict compare(const image::Picture& picture, const image::Picture& error, const image::Picture& reference,
                const image::Picture& referenceError, uint32_t tile, double tolerance) {
  for (const image::Picture* p : {&error, &reference, &referenceError})
    if (p->width != picture.width || p->height != picture.height) throw InputError("the pictures differ in size");
  if (tile == 0) throw InputError("tiles of no pixels");
  image::TileTest test;
  test.grid = {picture.width, picture.height, tile};
  std::vector<TileSums> sums(test.grid.count());
  TileSums whole;
  for (uint32_t y = 0; y < picture.height; ++y) {
    for (uint32_t x = 0; x < picture.width; ++x) {
      // The three colours of a pixel taken as fully correlated: errs on the side of silence.
      const double a = image::luminance(error.at(x, y)), b = image::luminance(referenceError.at(x, y));
      for (TileSums* s : {&sums[test.grid.index(x, y)], &whole}) {
        s->mean += image::luminance(picture.at(x, y));
        s->reference += image::luminance(reference.at(x, y));
        s->variance += a * a + b * b;
        ++s->pixels;
      }
    }
  }
  for (const TileSums& s : sums) {
    image::TileResult r{s.mean / s.pixels, s.reference / s.pixels, std::sqrt(s.variance) / s.pixels};
    r.t = r.standardError > 0 ? (r.mean - r.reference) / r.standardError : 0.0;
    r.relativeBias = r.reference != 0 ? (r.mean - r.reference) / r.reference : 0.0;
    test.tiles.push_back(r);
  }
  constexpr int kMany = 100000;  // hundreds of pixels a tile: as good as normal
  test.bound = image::studentTBound(kMany, 0.01, static_cast<int>(sums.size()));
  const double one = image::studentTBound(kMany, 0.01, 1);
  if (whole.reference != 0) {
    test.relativeBias = (whole.mean - whole.reference) / whole.reference;
    const double half = one * std::sqrt(whole.variance) / std::abs(whole.reference);
    test.intervalLow = test.relativeBias - half;
    test.intervalHigh = test.relativeBias + half;
  }
  return compare(test, tolerance);
}

}  // namespace weir::oracle
