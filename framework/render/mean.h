// Mean of pictures in double precision over the frames of one restart (over restarts: image/statistics.h).
#pragma once

#include <weir/image/image.h>

#include <cstdint>
#include <vector>

namespace weir::render {

/// Mean over frames; one restart's single sample.
class FrameMean {
 public:
  void add(const image::Picture& picture);
  image::Picture mean() const;

 private:
  uint32_t width_ = 0, height_ = 0;
  uint64_t count_ = 0;
  std::vector<double> sum_;
};

}  // namespace weir::render
