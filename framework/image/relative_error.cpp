#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/core/parallel.h>
#include <weir/image/metrics.h>
#include <weir/image/relative_error.h>
#include <weir/image/tiles.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace weir::image {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
/// Pixels a piece: sums are added in the pieces' order, so that results don't depend on the number of cores.
constexpr size_t kPiece = size_t{1} << 16;
constexpr int kBinBits = 11;  // of 31: exponent and three bits of the fraction

size_t pieces(size_t count) {
  return (count + kPiece - 1) / kPiece;
}

template <typename Work>
void forPieces(size_t count, const Work& work) {
  parallelFor(pieces(count), [&](size_t piece) { work(piece, piece * kPiece, std::min(count, (piece + 1) * kPiece)); });
}

/// Bits of floats ≥ 0 are in the order of the floats.
size_t binOf(float value) {
  return std::bit_cast<uint32_t>(value) >> (31 - kBinBits);
}

struct Histogram {
  std::array<uint64_t, size_t{1} << kBinBits> counts{};
  std::array<double, size_t{1} << kBinBits> sums{};
  void add(float value) {
    const size_t bin = binOf(value);
    ++counts[bin];
    sums[bin] += static_cast<double>(value);
  }
};

Histogram sumOf(const std::vector<Histogram>& parts) {
  Histogram all;
  for (const Histogram& part : parts) {
    for (size_t b = 0; b < all.counts.size(); ++b) {
      all.counts[b] += part.counts[b];
      all.sums[b] += part.sums[b];
    }
  }
  return all;
}

Histogram histogramOf(std::span<const float> values) {
  std::vector<Histogram> parts(pieces(values.size()));
  forPieces(values.size(), [&](size_t piece, size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      if (!std::isnan(values[i])) parts[piece].add(values[i]);
  });
  return sumOf(parts);
}

/// Where the `count` largest begin.
struct Cut {
  size_t bin = 0;
  uint64_t inside = 0;  ///< how many of that bin's values are among them
};

Cut cutOf(const Histogram& histogram, uint64_t count) {
  Cut cut{histogram.counts.size() - 1, count};
  while (cut.inside > histogram.counts[cut.bin] && cut.bin > 0) cut.inside -= histogram.counts[cut.bin--];
  return cut;
}

std::vector<float> valuesOf(std::span<const float> values, size_t bin) {
  std::vector<std::vector<float>> parts(pieces(values.size()));
  forPieces(values.size(), [&](size_t piece, size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      if (!std::isnan(values[i]) && binOf(values[i]) == bin) parts[piece].push_back(values[i]);
  });
  std::vector<float> all;
  for (const std::vector<float>& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

uint64_t countOf(const Histogram& histogram) {
  uint64_t n = 0;
  for (const uint64_t c : histogram.counts) n += c;
  return n;
}

struct Sums {
  double errors = 0, luminance = 0, missing = 0;
  uint64_t nonFinite = 0;
};

bool finite(const float* p) {
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

/// As trimmedMean(), with the histogram of the values.
double trimmedMeanOf(std::span<const float> values, const Histogram& histogram) {
  const uint64_t n = countOf(histogram);
  if (n == 0) return kNaN;
  const uint64_t dropped = n / 1000;
  double sum = 0;
  if (dropped == 0) {
    for (const double s : histogram.sums) sum += s;
    return sum / static_cast<double>(n);
  }
  const Cut cut = cutOf(histogram, dropped);
  for (size_t b = 0; b < cut.bin; ++b) sum += histogram.sums[b];
  std::vector<float> edge = valuesOf(values, cut.bin);
  const auto kept = edge.end() - static_cast<std::ptrdiff_t>(cut.inside);
  if (cut.inside > 0) std::nth_element(edge.begin(), kept, edge.end());
  for (auto v = edge.begin(); v != kept; ++v) sum += static_cast<double>(*v);
  return sum / static_cast<double>(n - dropped);
}

}  // namespace

double trimmedMean(std::span<const float> values) {
  return trimmedMeanOf(values, histogramOf(values));
}

float largestKept(std::span<const float> values) {
  const Histogram histogram = histogramOf(values);
  const uint64_t n = countOf(histogram);
  if (n == 0) return std::numeric_limits<float>::infinity();
  const Cut cut = cutOf(histogram, n / 1000 + 1);
  std::vector<float> edge = valuesOf(values, cut.bin);
  const auto first = edge.end() - static_cast<std::ptrdiff_t>(cut.inside);
  std::nth_element(edge.begin(), first, edge.end());
  return *first;
}

RelativeErrorMeter::RelativeErrorMeter(const Picture& reference)
    : reference_{reference.width, reference.height, reference.rgba, {}},
      pixels_(size_t{reference.width} * reference.height) {
  if (reference_.rgba.size() != 4 * pixels_.size() || pixels_.empty()) throw InputError("the reference lacks pixels");
  for (size_t i = 0; i < pixels_.size(); ++i) {
    const float* b = &reference_.rgba[4 * i];
    if (!finite(b))
      throw InputError(fmt::format("the reference has pixels that are not finite, the first at {}, {}",
                                   i % reference.width, i / reference.width));
    luminance_ += luminance(b);
  }
}

PictureError RelativeErrorMeter::measure(const Picture& test) {
  if (test.width != reference_.width || test.height != reference_.height || test.rgba.size() != reference_.rgba.size())
    throw InputError(fmt::format("the picture is {}x{} pixels, the reference {}x{}", test.width, test.height,
                                 reference_.width, reference_.height));
  // All in one pass, as starting threads and reading pictures take longer than the sums.
  std::vector<Sums> parts(pieces(pixels_.size()));
  std::vector<Histogram> histograms(parts.size());
  forPieces(pixels_.size(), [&](size_t piece, size_t begin, size_t end) {
    Sums sums;
    for (size_t i = begin; i < end; ++i) {
      const float *a = &test.rgba[4 * i], *b = &reference_.rgba[4 * i];
      if (!finite(a)) {
        pixels_[i] = std::numeric_limits<float>::quiet_NaN();
        sums.missing += luminance(b);
        ++sums.nonFinite;
        continue;
      }
      double relative = 0;
      for (int c = 0; c < 3; ++c) {
        const double difference = double(a[c]) - double(b[c]);
        relative += difference * difference / (double(b[c]) * double(b[c]) + kRelMseEpsilon);
      }
      relative /= 3.0;
      pixels_[i] = static_cast<float>(relative);
      histograms[piece].add(pixels_[i]);
      sums.errors += relative;
      sums.luminance += luminance(a);
    }
    parts[piece] = sums;
  });
  Sums all;
  for (const Sums& s : parts) {
    all.errors += s.errors;
    all.luminance += s.luminance;
    all.missing += s.missing;
    all.nonFinite += s.nonFinite;
  }
  PictureError e;
  e.nonFinite = all.nonFinite;
  e.relMse = all.errors / static_cast<double>(pixels_.size() - all.nonFinite);  // 0/0: a mean of nothing
  e.trimmed = trimmedMeanOf(pixels_, sumOf(histograms));
  const double expected = luminance_ - all.missing;
  e.relativeBias = expected > 0.0 ? (all.luminance - expected) / expected : kNaN;
  return e;
}

}  // namespace weir::image
