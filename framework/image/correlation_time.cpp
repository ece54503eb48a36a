#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/core/parallel.h>
#include <weir/image/correlation_time.h>
#include <weir/image/metrics.h>
#include <weir/image/relative_error.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace weir::image {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr size_t kPiece = size_t{1} << 15;

struct Sums {
  double ofMean = 0, ofFrame = 0;
};

/// What a pixel adds: of all sequences in [0], of all but r in [r + 1].
void pixelSums(std::span<const SequenceErrors> sequences, const Picture& reference, size_t pixel,
               std::span<Sums> sums) {
  const size_t n = sequences.size();
  const double count = static_cast<double>(n);
  double first[3] = {}, second[3] = {}, weight[3], within = 0;
  const auto difference = [&](size_t r, size_t c) {
    return double(sequences[r].mean.rgba[4 * pixel + c]) - double(reference.rgba[4 * pixel + c]);
  };
  for (size_t c = 0; c < 3; ++c) {
    const double b = reference.rgba[4 * pixel + c];
    weight[c] = 1.0 / (3.0 * (b * b + kRelMseEpsilon));
    for (size_t r = 0; r < n; ++r) {
      const double d = difference(r, c);
      first[c] += d;
      second[c] += d * d;
    }
  }
  const auto own = [&](size_t r) {  // inside of sequence r
    double e = sequences[r].errors[pixel];
    for (size_t c = 0; c < 3; ++c) e -= weight[c] * difference(r, c) * difference(r, c);
    return e;
  };
  for (size_t r = 0; r < n; ++r) within += own(r);
  double between = 0;
  for (size_t c = 0; c < 3; ++c) between += weight[c] * (second[c] - first[c] * first[c] / count) / (count - 1);
  sums[0] = {between, within / count + between};
  if (n < 3) return;
  for (size_t r = 0; r < n; ++r) {
    double left = 0;
    for (size_t c = 0; c < 3; ++c) {
      const double d = difference(r, c), f = first[c] - d;
      left += weight[c] * (second[c] - d * d - f * f / (count - 1)) / (count - 2);
    }
    sums[r + 1] = {left, (within - own(r)) / (count - 1) + left};
  }
}

bool usable(std::span<const SequenceErrors> sequences, size_t pixel) {
  return std::ranges::all_of(sequences, [&](const SequenceErrors& s) {
    const float* m = &s.mean.rgba[4 * pixel];
    return std::isfinite(s.errors[pixel]) && std::isfinite(m[0]) && std::isfinite(m[1]) && std::isfinite(m[2]);
  });
}

double ratio(const Sums& sums, uint64_t frames) {
  if (!(sums.ofFrame > 0)) return kNaN;
  return untruncatedTime(static_cast<double>(frames) * sums.ofMean / sums.ofFrame, frames);
}

}  // namespace

double untruncatedTime(double timeOfN, uint64_t frames) {
  if (std::isnan(timeOfN) || frames == 0) return kNaN;
  const double n = static_cast<double>(frames);
  if (timeOfN >= n) return frames == 1 ? 1.0 : std::numeric_limits<double>::infinity();
  if (timeOfN <= 0) return 0.0;
  // τ_N grows with ρ: bisection.
  double low = -1.0, high = 1.0;
  for (int i = 0; i < 200; ++i) {
    const double rho = 0.5 * (low + high), left = 1 - rho;
    const double seen = (1 + rho) / left - 2 * rho * (1 - std::pow(rho, n)) / (n * left * left);
    (seen < timeOfN ? low : high) = rho;
  }
  const double rho = 0.5 * (low + high);
  return (1 + rho) / (1 - rho);
}

Interval correlationTime(std::span<const SequenceErrors> sequences, const Picture& reference, uint64_t frames) {
  const size_t pixels = size_t{reference.width} * reference.height, n = sequences.size();
  for (const SequenceErrors& s : sequences)
    if (s.mean.rgba.size() != 4 * pixels || s.errors.size() != pixels || reference.rgba.size() != 4 * pixels)
      throw InputError("correlation time: pictures of different sizes");
  if (n < 2 || frames < 2) return {kNaN, kNaN, kNaN};
  const size_t pieces = (pixels + kPiece - 1) / kPiece;
  const auto forPieces = [&](const auto& work) {
    parallelFor(pieces, [&](size_t piece) {
      std::vector<Sums> one(n + 1);
      for (size_t i = piece * kPiece; i < std::min(pixels, (piece + 1) * kPiece); ++i) {
        if (!usable(sequences, i)) continue;
        pixelSums(sequences, reference, i, one);
        work(piece, i, one);
      }
    });
  };
  // Which pixels vary most is asked first.
  std::vector<float> variance(pixels, 0.0f);
  forPieces([&](size_t, size_t i, const std::vector<Sums>& one) {
    variance[i] = static_cast<float>(std::max(one[0].ofFrame, 0.0));
  });
  const float most = largestKept(variance);
  std::vector<std::vector<Sums>> parts(pieces, std::vector<Sums>(n + 1));
  forPieces([&](size_t piece, size_t i, const std::vector<Sums>& one) {
    if (variance[i] > most) return;
    for (size_t k = 0; k <= n; ++k) {
      parts[piece][k].ofMean += one[k].ofMean;
      parts[piece][k].ofFrame += one[k].ofFrame;
    }
  });
  std::vector<Sums> all(n + 1);
  for (const std::vector<Sums>& part : parts) {
    for (size_t k = 0; k <= n; ++k) {
      all[k].ofMean += part[k].ofMean;
      all[k].ofFrame += part[k].ofFrame;
    }
  }
  std::vector<double> without;
  for (size_t r = 0; r < n && n >= 3; ++r) without.push_back(ratio(all[r + 1], frames));
  Interval result = jackknifeInterval(ratio(all[0], frames), without);
  if (result.low < 0) result.low = 0;  // frames can be no better than that
  return result;
}

}  // namespace weir::image
