#include <weir/chart/log_axis.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace weir::chart {

LogAxis::LogAxis(const std::vector<double>& values, double from, double to) : from_(from), to_(to) {
  if (values.empty()) return;
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  // Bounds so that neither the room nor a product of two axes leaves what a double holds.
  const double low = std::clamp(*least, 1e-100, 1e100), high = std::clamp(*most, 1e-100, 1e100);
  const double room = std::max(std::pow(high / low, 0.06), high / low < 1.5 ? 1.3 : 1.0);
  low_ = low / room;
  high_ = high * room;
}

double LogAxis::at(double value) const {
  return from_ + (to_ - from_) * (std::log(value) - std::log(low_)) / (std::log(high_) - std::log(low_));
}

double LogAxis::clipped(double value) const {
  return at(std::clamp(value, low_, high_));
}

std::vector<double> LogAxis::ticks() const {
  std::vector<double> result;
  const double decades = std::log10(high_ / low_);
  if (decades < 1) {
    const double raw = (high_ - low_) / 5, unit = std::pow(10.0, std::floor(std::log10(raw)));
    const double step = unit * (raw / unit > 5 ? 10 : raw / unit > 2 ? 5 : raw / unit > 1 ? 2 : 1);
    const double first = std::ceil(low_ / step), last = std::floor(high_ / step);
    for (int i = 0; i <= static_cast<int>(last - first); ++i) result.push_back((first + i) * step);
    return result;
  }
  const int every = std::max(1, static_cast<int>(decades / 8));
  for (int k = static_cast<int>(std::floor(std::log10(low_))); k <= static_cast<int>(std::ceil(std::log10(high_)));
       ++k) {
    if (k % every != 0) continue;
    for (const double multiple : {1.0, 2.0, 5.0}) {
      const double value = multiple * std::pow(10.0, k);
      if ((multiple == 1.0 || decades < 3) && value >= low_ && value <= high_) result.push_back(value);
    }
  }
  return result;
}

std::string tickText(double value) {
  return fmt::format("{:.6g}", value);
}

}  // namespace weir::chart
