// Means of pictures in double precision: over the frames of a restart, then over restarts.
#pragma once

#include <weir/image/image.h>

#include <cstdint>
#include <vector>

namespace weir::render {

/// Mean over frames; one restart's single sample.
class FrameMean {
 public:
  void add(const image::Picture& picture);
  double value(size_t i) const { return sum_[i] / static_cast<double>(count_); }
  size_t size() const { return sum_.size(); }
  uint32_t width() const { return width_; }
  uint32_t height() const { return height_; }

 private:
  uint32_t width_ = 0, height_ = 0;
  uint64_t count_ = 0;
  std::vector<double> sum_;
};

/// Mean and standard error over restarts (Welford 1962).
class RestartMean {
 public:
  void add(const FrameMean& sample);
  image::Picture mean() const;
  /// sqrt(variance of the samples / their number); alpha is 1.
  image::Picture standardError() const;

 private:
  uint32_t width_ = 0, height_ = 0;
  uint64_t count_ = 0;
  std::vector<double> mean_, squares_;
};

}  // namespace weir::render
