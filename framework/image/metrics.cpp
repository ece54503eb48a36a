#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/image/flip.h>
#include <weir/image/metrics.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace weir::image {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

enum class Use : unsigned char { Masked, NonFinite, Counted };

bool finite(const float* p) {
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

void requireSameSize(const Picture& picture, const Picture& reference, const char* what) {
  if (picture.width != reference.width || picture.height != reference.height) {
    throw InputError(fmt::format("{} is {}x{} pixels, the reference {}x{}", what, picture.width, picture.height,
                                 reference.width, reference.height));
  }
  if (picture.rgba.size() != reference.rgba.size()) throw InputError(fmt::format("{} lacks pixels", what));
}

/// What becomes of every pixel. Throws when there is nothing to compare.
std::vector<Use> classify(const Picture& test, const Picture& reference, const Picture* mask) {
  requireSameSize(test, reference, "the picture");
  if (mask) requireSameSize(*mask, reference, "the mask");
  std::vector<Use> use(size_t{reference.width} * reference.height, Use::Counted);
  bool any = false;
  for (size_t i = 0; i < use.size(); ++i) {
    const float* m = mask ? &mask->rgba[4 * i] : nullptr;
    if (m && !(std::max({m[0], m[1], m[2]}) > 0.5f)) {
      use[i] = Use::Masked;
      continue;
    }
    any = true;
    if (!finite(&test.rgba[4 * i]) || !finite(&reference.rgba[4 * i])) use[i] = Use::NonFinite;
  }
  if (!any) throw InputError("the mask leaves no pixel to compare");
  return use;
}

/// The smallest value that at least the fraction p of all values do not exceed (nearest rank). Reorders `values`.
double percentile(std::vector<double>& values, double p) {
  if (values.empty()) return kNaN;
  const double rank = std::ceil(p * double(values.size()));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::max(rank, 1.0)) - 1;
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double trimmedMean(std::vector<double>& values) {
  if (values.empty()) return kNaN;
  const size_t kept = values.size() - values.size() / 1000;
  if (kept < values.size()) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(kept), values.end());
  }
  return std::accumulate(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(kept), 0.0) / double(kept);
}

void measureFlip(const Picture& test, const Picture& reference, const MetricOptions& options,
                 const std::vector<Use>& use, Metrics& metrics) {
  const bool replace = std::any_of(use.begin(), use.end(), [](Use u) { return u != Use::Counted; });
  Picture cleanTest, cleanReference;
  if (replace) {
    cleanTest = test;
    cleanReference = reference;
    for (size_t i = 0; i < use.size(); ++i) {
      float *a = &cleanTest.rgba[4 * i], *b = &cleanReference.rgba[4 * i];
      if (finite(a) && finite(b)) continue;
      if (!finite(b)) b[0] = b[1] = b[2] = 0.0f;
      std::copy(b, b + 3, a);
    }
  }
  const Picture& a = replace ? cleanTest : test;
  const Picture& b = replace ? cleanReference : reference;
  const std::vector<float> map =
      options.hdr ? hdrFlip(a, b, options.pixelsPerDegree, options.stop) : ldrFlip(a, b, options.pixelsPerDegree);
  if (map.empty()) return;  // stopped
  std::vector<double> counted;
  for (size_t i = 0; i < use.size(); ++i) {
    if (use[i] == Use::Counted) counted.push_back(double(map[i]));
  }
  metrics.flipMean = std::accumulate(counted.begin(), counted.end(), 0.0) / double(counted.size());
  metrics.flipP99 = percentile(counted, 0.99);
}

}  // namespace

Metrics measure(const Picture& test, const Picture& reference, const MetricOptions& options) {
  const std::vector<Use> use = classify(test, reference, options.mask);
  Metrics m;
  double bias[3] = {}, luminanceA = 0, luminanceB = 0;
  std::vector<double> perPixel;
  perPixel.reserve(use.size());
  for (size_t i = 0; i < use.size(); ++i) {
    m.nonFinite += use[i] == Use::NonFinite;
    if (use[i] != Use::Counted) continue;
    const float *a = &test.rgba[4 * i], *b = &reference.rgba[4 * i];
    double relative = 0;
    for (int c = 0; c < 3; ++c) {
      const double difference = double(a[c]) - double(b[c]), square = difference * difference;
      m.mse += square;
      relative += square / (double(b[c]) * double(b[c]) + kRelMseEpsilon);
      m.mape += std::abs(difference) / (std::abs(double(b[c])) + kMapeEpsilon);
      bias[c] += difference;
    }
    m.relMse += relative;
    perPixel.push_back(relative / 3.0);
    luminanceA += luminance(a);
    luminanceB += luminance(b);
  }
  m.pixels = perPixel.size();
  const double n = double(m.pixels);  // 0/0 is NaN, which is what a mean of nothing is
  m.mse /= 3.0 * n;
  m.relMse /= 3.0 * n;
  m.mape /= 3.0 * n;
  m.biasR = bias[0] / n;
  m.biasG = bias[1] / n;
  m.biasB = bias[2] / n;
  m.relativeBias = luminanceB > 0.0 ? (luminanceA - luminanceB) / luminanceB : kNaN;
  m.relMseMedian = percentile(perPixel, 0.5);
  m.relMseTrimmed = trimmedMean(perPixel);
  m.flipMean = m.flipP99 = kNaN;
  if (options.flip && m.pixels > 0) measureFlip(test, reference, options, use, m);
  return m;
}

TileSummary compareTiles(const Picture& test, const Picture& reference, uint32_t side, const Picture* mask) {
  if (side == 0) throw InputError("a tile needs at least one pixel a side");
  const std::vector<Use> use = classify(test, reference, mask);
  TileSummary summary;
  summary.grid = {reference.width, reference.height, side};
  const TileGrid& grid = summary.grid;
  summary.tiles.resize(grid.count());
  double total = 0, counted = 0;
  for (uint32_t y = 0; y < grid.height; ++y) {
    for (uint32_t x = 0; x < grid.width; ++x) {
      if (use[size_t{y} * grid.width + x] != Use::Counted) continue;
      TileDifference& tile = summary.tiles[grid.index(x, y)];
      const float *a = test.at(x, y), *b = reference.at(x, y);
      ++tile.pixels;
      tile.differenceR += double(a[0]) - double(b[0]);
      tile.differenceG += double(a[1]) - double(b[1]);
      tile.differenceB += double(a[2]) - double(b[2]);
      tile.difference += luminance(a) - luminance(b);
      tile.reference += luminance(b);
      total += luminance(b);
      ++counted;
    }
  }
  const double floor = counted > 0 ? std::max(0.01 * total / counted, 0.0) : 0.0;
  double squares = 0, tiles = 0;
  for (size_t i = 0; i < summary.tiles.size(); ++i) {
    TileDifference& tile = summary.tiles[i];
    tile.x = grid.left(i);
    tile.y = grid.top(i);
    if (tile.pixels == 0) continue;
    for (double* v : {&tile.differenceR, &tile.differenceG, &tile.differenceB, &tile.difference, &tile.reference}) {
      *v /= double(tile.pixels);
    }
    const double denominator = std::max(tile.reference, floor);
    tile.relative = tile.difference == 0.0 ? 0.0 : denominator > 0.0 ? tile.difference / denominator : kNaN;
    squares += tile.relative * tile.relative;
    ++tiles;
    summary.worst.push_back(i);
  }
  summary.rmsRelative = std::sqrt(squares / tiles);
  // Undefined ones before all others, as NaN has no place in an order.
  const auto size = [&](size_t i) {
    const double relative = std::abs(summary.tiles[i].relative);
    return std::isnan(relative) ? std::numeric_limits<double>::infinity() : relative;
  };
  const auto larger = [&](size_t a, size_t b) { return size(a) > size(b); };
  const size_t shown = std::min<size_t>(5, summary.worst.size());
  std::partial_sort(summary.worst.begin(), summary.worst.begin() + static_cast<std::ptrdiff_t>(shown),
                    summary.worst.end(), larger);
  summary.worst.resize(shown);
  if (shown > 0) summary.maxRelative = std::abs(summary.tiles[summary.worst[0]].relative);
  return summary;
}

std::vector<std::string> attributeConflicts(const Picture& test, const Picture& reference) {
  std::vector<std::string> conflicts;
  for (const char* name : {"weir.scene", "weir.animation", "weir.camera", "weir.lights", "weir.shading"}) {
    const auto a = test.attributes.find(name), b = reference.attributes.find(name);
    if (a == test.attributes.end() || b == reference.attributes.end() || a->second == b->second) continue;
    conflicts.push_back(fmt::format("{}: '{}' here, '{}' in the reference", name, a->second, b->second));
  }
  return conflicts;
}

}  // namespace weir::image
