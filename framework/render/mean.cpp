#include <weir/render/mean.h>

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

image::Picture FrameMean::mean() const {
  image::Picture p{width_, height_, std::vector<float>(sum_.size()), {}};
  for (size_t i = 0; i < sum_.size(); ++i) p.rgba[i] = static_cast<float>(sum_[i] / static_cast<double>(count_));
  return p;
}

}  // namespace weir::render
