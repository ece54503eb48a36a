#include <weir/core/parallel.h>
#include <weir/render/mean.h>

#include <algorithm>

namespace weir::render {

void FrameMean::add(const image::Picture& picture) {
  if (sum_.empty()) {
    width_ = picture.width;
    height_ = picture.height;
    sum_.assign(picture.rgba.size(), 0.0);
  }
  // In pieces, as a large picture would take one core longer than a GPU takes for the next one.
  constexpr size_t kPiece = size_t{1} << 18;
  parallelFor((sum_.size() + kPiece - 1) / kPiece, [&](size_t piece) {
    const size_t end = std::min(sum_.size(), (piece + 1) * kPiece);
    for (size_t i = piece * kPiece; i < end; ++i) sum_[i] += picture.rgba[i];
  });
  ++count_;
}

image::Picture FrameMean::mean() const {
  image::Picture p{width_, height_, std::vector<float>(sum_.size()), {}};
  for (size_t i = 0; i < sum_.size(); ++i) p.rgba[i] = static_cast<float>(sum_[i] / static_cast<double>(count_));
  return p;
}

}  // namespace weir::render
