#include "view/compare/trail.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace weir::view {
namespace {

double quantile(const std::vector<double>& sorted, double p) {
  const double place = p * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<size_t>(place);
  const size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (sorted[above] - sorted[below]) * (place - static_cast<double>(below));
}

/// As RFC 4180 has it.
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"') result += '"';
    result += c;
  }
  return result + "\"";
}

}  // namespace

Spread spreadOf(std::vector<double> values) {
  std::ranges::sort(values);
  return {quantile(values, 0.25), quantile(values, 0.5), quantile(values, 0.75)};
}

std::vector<size_t> paretoFront(const std::vector<TrailPoint>& points) {
  std::vector<size_t> front;
  for (size_t i = 0; i < points.size(); ++i) {
    const double x = points[i].milliseconds.median, y = points[i].relMse.median;
    const bool beaten = std::ranges::any_of(points, [&](const TrailPoint& other) {
      const double u = other.milliseconds.median, v = other.relMse.median;
      return u <= x && v <= y && (u < x || v < y);
    });
    if (!beaten) front.push_back(i);
  }
  std::ranges::stable_sort(front, {}, [&](size_t i) { return points[i].milliseconds.median; });
  return front;
}

void Trail::warmUp(uint64_t frames, std::string reason) {
  warmUp_ = frames;
  reason_ = std::move(reason);
}

void Trail::begin(uint64_t frame) {
  times_.clear();
  errors_.clear();
  leftOut_ = warmUp_;
  first_ = frame + warmUp_;
  newest_ = frame;
  seen_ = false;
}

void Trail::keep(TrailPoint point) {
  if (options_.old == 0) return;
  old_.push_back(std::move(point));
  if (old_.size() <= options_.old) return;
  // The oldest that something else beats anyway; what is on the front is why one looks at the plane.
  const std::vector<size_t> front = paretoFront(old_);
  size_t goes = 0;
  while (goes < old_.size() && std::ranges::count(front, goes) > 0) ++goes;
  old_.erase(old_.begin() + static_cast<std::ptrdiff_t>(goes == old_.size() ? 0 : goes));
}

void Trail::change(uint64_t frame, const KnobChange& change) {
  if (std::optional<TrailPoint> point = current()) {
    keep(*std::move(point));
    changes_.clear();
  }
  const auto same = std::ranges::find(changes_, change.knob, &KnobChange::knob);
  if (same == changes_.end()) {
    changes_.push_back(change);
  } else {
    same->to = change.to;
  }
  begin(frame);
}

void Trail::restart(uint64_t frame) {
  old_.clear();
  changes_.clear();
  begin(frame);
}

void Trail::addTime(uint64_t frame, double milliseconds) {
  newest_ = seen_ ? std::max(newest_, frame) : frame;
  seen_ = true;
  if (frame < first_ || !(milliseconds > 0.0) || !std::isfinite(milliseconds)) return;
  if (times_.size() == options_.window) times_.erase(times_.begin());
  times_.push_back(milliseconds);
}

void Trail::addError(uint64_t frame, double relMse, double relMseTrimmed, double relativeBias) {
  if (frame < first_ || !std::isfinite(relMse)) return;
  const Error error{frame, relMse, relMseTrimmed, relativeBias};
  if (!errors_.empty() && errors_.back().frame == frame) {
    errors_.back() = error;
    return;
  }
  if (errors_.size() == options_.window) errors_.erase(errors_.begin());
  errors_.push_back(error);
}

std::string Trail::label() const {
  std::string text;
  for (const KnobChange& c : changes_)
    if (c.from != c.to) text += fmt::format("{}{} {} → {}", text.empty() ? "" : ", ", c.knob, c.from, c.to);
  if (!text.empty()) return text;
  return changes_.empty() ? "start" : "as before";  // turned back before there was a point
}

std::optional<TrailPoint> Trail::current() const {
  const size_t fewest = std::max<size_t>(options_.fewest, 1);
  if (times_.size() < fewest || errors_.size() < fewest) return std::nullopt;
  std::vector<double> relMse, trimmed;
  double bias = 0.0;
  for (const Error& e : errors_) {
    relMse.push_back(e.relMse);
    trimmed.push_back(e.trimmed);
    bias += e.bias;
  }
  TrailPoint point;
  point.label = label();
  point.milliseconds = spreadOf(times_);
  point.relMse = spreadOf(std::move(relMse));
  point.relMseTrimmed = spreadOf(std::move(trimmed)).median;
  point.relativeBias = bias / static_cast<double>(errors_.size());
  point.frames = times_.size();
  point.pictures = errors_.size();
  return point;
}

std::vector<TrailPoint> Trail::all() const {
  std::vector<TrailPoint> points = old_;
  if (std::optional<TrailPoint> now = current()) points.push_back(*std::move(now));
  return points;
}

std::vector<size_t> Trail::front() const {
  return paretoFront(all());
}

std::string Trail::words() const {
  const uint64_t begun = first_ - leftOut_;
  const uint64_t passed = seen_ && newest_ >= begun ? newest_ - begun + 1 : 0;
  if (leftOut_ > 0 && passed < leftOut_) return fmt::format("{} of {} frames left out: {}", passed, leftOut_, reason_);
  std::string made = fmt::format("median of {} frame{} and {} picture{}", times_.size(), times_.size() == 1 ? "" : "s",
                                 errors_.size(), errors_.size() == 1 ? "" : "s");
  if (current()) return made;
  if (seen_ && newest_ >= first_ && times_.empty()) return "no times: the device measures none";
  return fmt::format("{}: at least {} of each are wanted", made, options_.fewest);
}

std::string Trail::csv() const {
  const std::vector<TrailPoint> points = all();
  const std::vector<size_t> front = paretoFront(points);
  std::string text =
      "label,gpu_ms,gpu_ms_q1,gpu_ms_q3,rel_mse,rel_mse_q1,rel_mse_q3,rel_mse_trimmed,relative_bias,frames,pictures,"
      "pareto,current\n";
  for (size_t i = 0; i < points.size(); ++i) {
    const TrailPoint& p = points[i];
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", quoted(p.label), p.milliseconds.median,
                        p.milliseconds.low, p.milliseconds.high, p.relMse.median, p.relMse.low, p.relMse.high,
                        p.relMseTrimmed, p.relativeBias, p.frames, p.pictures, std::ranges::count(front, i),
                        i >= old_.size() ? 1 : 0);
  }
  return text;
}

}  // namespace weir::view
