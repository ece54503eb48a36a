#include <weir/core/parallel.h>
#include <weir/render/mean.h>

#include <algorithm>

namespace weir::render {
namespace {

/// As a large picture would take one core longer than a GPU takes for the next one.
template <typename Work>
void inPieces(size_t count, const Work& work) {
  constexpr size_t kPiece = size_t{1} << 18;
  parallelFor((count + kPiece - 1) / kPiece, [&](size_t piece) {
    const size_t end = std::min(count, (piece + 1) * kPiece);
    for (size_t i = piece * kPiece; i < end; ++i) work(i);
  });
}

}  // namespace

void FrameMean::add(const image::Picture& picture) {
  if (sum_.empty()) {
    width_ = picture.width;
    height_ = picture.height;
    sum_.assign(picture.rgba.size(), 0.0);
  }
  inPieces(sum_.size(), [&](size_t i) { sum_[i] += picture.rgba[i]; });
  ++count_;
}

image::Picture FrameMean::mean() const {
  image::Picture p{width_, height_, std::vector<float>(sum_.size()), {}};
  inPieces(sum_.size(), [&](size_t i) { p.rgba[i] = static_cast<float>(sum_[i] / static_cast<double>(count_)); });
  return p;
}

}  // namespace weir::render
