#include <weir/image/interval.h>
#include <weir/image/student.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace weir::image {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double meanOf(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Half the width of the interval around the mean of independent values.
double reach(std::span<const double> values) {
  const double mean = meanOf(values), n = static_cast<double>(values.size());
  double squares = 0;
  for (const double v : values) squares += (v - mean) * (v - mean);
  const double t = studentTQuantile(0.5 + kConfidence / 2, static_cast<int>(values.size()) - 1);
  return t * std::sqrt(squares / (n * (n - 1)));
}

}  // namespace

Interval meanInterval(std::span<const double> values) {
  if (values.empty()) return {kNaN, kNaN, kNaN};
  const double mean = meanOf(values);
  if (!std::isfinite(mean)) return {kNaN, kNaN, kNaN};
  if (values.size() < 2) return {mean, kNaN, kNaN};
  const double half = reach(values);
  return {mean, mean - half, mean + half};
}

Interval jackknifeInterval(double whole, std::span<const double> without) {
  if (!std::isfinite(whole)) return {kNaN, kNaN, kNaN};
  if (without.size() < 3) return {whole, kNaN, kNaN};
  const double n = static_cast<double>(without.size());
  std::vector<double> pseudo;
  for (const double w : without) pseudo.push_back(n * whole - (n - 1) * w);
  const double half = reach(pseudo);
  if (!std::isfinite(half)) return {whole, kNaN, kNaN};
  return {whole, whole - half, whole + half};
}

}  // namespace weir::image
