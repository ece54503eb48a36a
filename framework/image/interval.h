// A figure with its 95 % confidence interval, from few independent repeats.
#pragma once

#include <span>

namespace weir::image {

inline constexpr double kConfidence = 0.95;

/// NaN where nothing is known; the ends are NaN where there are too few repeats to say.
struct Interval {
  double value = 0, low = 0, high = 0;
};

/// Mean of independent values and Student's t interval of n - 1 degrees of freedom. The ends are NaN for one value; all
/// is NaN for none, or where a value is not finite.
Interval meanInterval(std::span<const double> values);

/// Of a figure worked out from all repeats at once: the jackknife (Tukey 1958). `whole`: from all n repeats;
/// `without`[r]: from all but r. Pseudo-values n · whole - (n - 1) · without[r] are treated as independent: their
/// mean's standard error and t of n - 1 degrees of freedom, around `whole`. The ends are NaN for fewer than three
/// repeats, as what is left then knows no spread.
Interval jackknifeInterval(double whole, std::span<const double> without);

}  // namespace weir::image
