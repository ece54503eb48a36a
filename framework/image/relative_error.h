// relMSE of one picture after another against one reference, on all cores: what a bench asks of every frame, while the
// GPU goes on. The same figures as image/metrics.h has, which is for one picture and knows more of them.
#pragma once

#include <weir/image/image.h>

#include <cstdint>
#include <span>
#include <vector>

namespace weir::image {

struct PictureError {
  double relMse = 0;        ///< as Metrics::relMse; NaN where no pixel is finite
  double trimmed = 0;       ///< as Metrics::relMseTrimmed
  double relativeBias = 0;  ///< as Metrics::relativeBias
  uint64_t nonFinite = 0;   ///< pixels of the picture that are left out
};

class RelativeErrorMeter {
 public:
  /// Keeps a copy: 28 bytes a pixel with what else it needs. Throws InputError where the reference has pixels that are
  /// not finite.
  explicit RelativeErrorMeter(const Picture& reference);

  /// Throws InputError when the size is another one. Not for several threads at once.
  PictureError measure(const Picture& test);
  /// Of the last picture, by pixel: mean over R, G, B of (a - b)² / (b² + 0.01). NaN where a is not finite.
  std::span<const float> pixels() const { return pixels_; }
  const Picture& reference() const { return reference_; }

 private:
  Picture reference_;
  std::vector<float> pixels_;
  double luminance_ = 0;  ///< sum over all pixels of the reference
};

/// Mean of `values` (≥ 0; NaN are left out) without the floor(n/1000) largest, n the number of those that are left. The
/// same as sorting them, in two passes: a histogram of their leading bits finds where the largest begin. NaN for none.
double trimmedMean(std::span<const float> values);
/// The largest of those values. Infinity for none.
float largestKept(std::span<const float> values);

}  // namespace weir::image
