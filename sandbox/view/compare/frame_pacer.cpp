#include "view/compare/frame_pacer.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace weir::view {

void FramePacer::grant(double milliseconds) {
  granted_ = milliseconds > 0.0;
  spent_ = false;
  if (granted_) credit_ = std::min(credit_ + milliseconds, std::max(milliseconds, cost_.value_or(0.0)));
}

bool FramePacer::affords() const {
  if (!granted_) return false;
  return cost_ ? credit_ >= *cost_ : !spent_;
}

void FramePacer::spend() {
  spent_ = true;
  credit_ = std::max(credit_ - cost_.value_or(credit_), 0.0);
}

void FramePacer::measured(double milliseconds) {
  if (!(milliseconds > 0.0) || !std::isfinite(milliseconds)) return;
  if (!std::exchange(warm_, true)) return;
  // Odd and few: it follows soon when frames become longer, and one that was held up does not count.
  constexpr size_t kKept = 9;
  if (last_.size() < kKept) {
    last_.push_back(milliseconds);
  } else {
    last_[next_] = milliseconds;
    next_ = (next_ + 1) % kKept;
  }
  std::vector<double> sorted = last_;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>((sorted.size() - 1) / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  cost_ = *middle;
}

void FramePacer::forget() {
  *this = {};
}

}  // namespace weir::view
