// A logarithmic axis: its range, where values lie on it and where its ticks are.
#pragma once

#include <string>
#include <vector>

namespace weir::chart {

class LogAxis {
 public:
  /// From `from` (where the smallest value is, in pixels) to `to`, holding every value with some room; all are above
  /// zero.
  LogAxis(const std::vector<double>& values, double from, double to);

  double low() const { return low_; }
  double high() const { return high_; }
  double at(double value) const;       ///< in pixels; outside of the range too
  double clipped(double value) const;  ///< the same, kept inside
  /// Powers of ten and, where there are few of these, multiples of them; equal steps when all is within one decade.
  std::vector<double> ticks() const;

 private:
  double low_ = 1, high_ = 10, from_, to_;
};

/// As short as it can be for a tick: "0.02", "1e-06".
std::string tickText(double value);

}  // namespace weir::chart
