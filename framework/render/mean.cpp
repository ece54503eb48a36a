#include <weir/render/mean.h>

#include <cmath>

namespace weir::render {

void FrameMean::add(const image::Picture& picture) {
  if (sum_.empty()) {
    width_ = picture.width;
    height_ = picture.height;
    sum_.assign(picture.rgba.size(), 0.0);
  }
  for (size_t i = 0; i < sum_.size(); ++i) sum_[i] += picture.rgba[i];
  ++count_;
}

void RestartMean::add(const FrameMean& sample) {
  if (mean_.empty()) {
    width_ = sample.width();
    height_ = sample.height();
    mean_.assign(sample.size(), 0.0);
    squares_.assign(sample.size(), 0.0);
  }
  ++count_;
  for (size_t i = 0; i < mean_.size(); ++i) {
    const double value = sample.value(i), delta = value - mean_[i];
    mean_[i] += delta / static_cast<double>(count_);
    squares_[i] += delta * (value - mean_[i]);
  }
}

image::Picture RestartMean::mean() const {
  image::Picture p{width_, height_, {mean_.begin(), mean_.end()}, {}};
  return p;
}

image::Picture RestartMean::standardError() const {
  image::Picture p{width_, height_, std::vector<float>(mean_.size(), 1.0f), {}};
  const double n = static_cast<double>(count_);
  for (size_t i = 0; i < mean_.size(); ++i) {
    if (i % 4 != 3) p.rgba[i] = static_cast<float>(std::sqrt(squares_[i] / (n - 1.0) / n));
  }
  return p;
}

}  // namespace weir::render
