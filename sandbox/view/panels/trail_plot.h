// The plane of error against time on logarithmic axes: settings before as faint points, the present one with its
// spread, and the front of those that nothing beats.
#pragma once

#include <string>
#include <vector>

#include "view/compare/comparison.h"
#include "view/ui/ui.h"

namespace weir::view {

/// A logarithmic axis that holds some values.
class LogAxis {
 public:
  /// With some room around them, and at least a third of a decade long. Values that are not above 0 lie at its low end;
  /// without others it is 1 … 10.
  explicit LogAxis(const std::vector<double>& values);
  double low() const { return low_; }
  double high() const { return high_; }
  /// Where a value lies: 0 at the low end, 1 at the high one.
  double place(double value) const;
  /// Round values within, low to high: 1, 2 and 5 of each decade, of long axes its beginning alone.
  std::vector<double> ticks() const;

 private:
  double low_ = 1.0, high_ = 10.0;
};

/// Draws into that rectangle of the window that is open. Returns the number of the point under the mouse, or -1.
int drawTrail(Ui& ui, const Rectangle& where, const ComparisonState& state);

/// "spatial.radius 6 → 12: 4.73 ms, relMSE 0.0869 (0.085 … 0.089), bias +0.1 %, of 128 frames and 40 pictures"
std::string inWords(const TrailPoint& point);

}  // namespace weir::view
