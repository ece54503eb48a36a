#include "view/panels/trail_plot.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "view/ui/style.h"

namespace weir::view {

LogAxis::LogAxis(const std::vector<double>& values) {
  bool any = false;
  double low = 0.0, high = 0.0;
  for (const double v : values) {
    if (!(v > 0.0) || !std::isfinite(v)) continue;
    const double place = std::log10(v);
    low = any ? std::min(low, place) : place;
    high = any ? std::max(high, place) : place;
    any = true;
  }
  if (!any) return;
  constexpr double kShortest = 1.0 / 3.0, kRoom = 0.08;
  const double room = kRoom * (high - low) + 0.5 * std::max(kShortest - (high - low), 0.0);
  // Room beyond what a double holds is none.
  low_ = std::max(std::pow(10.0, low - room), std::numeric_limits<double>::min());
  high_ = std::clamp(std::pow(10.0, high + room), 2.0 * low_, std::numeric_limits<double>::max());
}

double LogAxis::place(double value) const {
  if (!(value > low_)) return 0.0;
  return std::min((std::log10(value) - std::log10(low_)) / (std::log10(high_) - std::log10(low_)), 1.0);
}

std::vector<double> LogAxis::ticks() const {
  std::vector<double> ticks;
  const int first = static_cast<int>(std::floor(std::log10(low_))),
            last = static_cast<int>(std::ceil(std::log10(high_)));
  constexpr int kLong = 3;
  const int step = std::max((last - first) / 8, 1);  // of thirty decades not all
  for (int decade = first; decade <= last; decade += step) {
    for (const double m : {1.0, 2.0, 5.0}) {
      const double value = m * std::pow(10.0, decade);
      if (value < low_ || value > high_ || (m > 1.0 && last - first > kLong)) continue;
      ticks.push_back(value);
    }
  }
  return ticks;
}

std::string inWords(const TrailPoint& p) {
  const std::string bias = std::isfinite(p.relativeBias) ? fmt::format(", bias {:+.2g} %", 100.0 * p.relativeBias) : "";
  return fmt::format("{}: {:.3g} ms, relMSE {:.3g} ({:.3g} … {:.3g}){}, of {} frames and {} pictures", p.label,
                     p.milliseconds.median, p.relMse.median, p.relMse.low, p.relMse.high, bias, p.frames, p.pictures);
}

namespace {

struct Plot {
  ImDrawList& draw;
  ImVec2 low, high;  ///< of the plot, window coordinates
  LogAxis x, y;
  float scale;
  ImVec2 at(double milliseconds, double relMse) const {
    return {low.x + static_cast<float>(x.place(milliseconds)) * (high.x - low.x),
            high.y - static_cast<float>(y.place(relMse)) * (high.y - low.y)};
  }
  ImVec2 at(const TrailPoint& p) const { return at(p.milliseconds.median, p.relMse.median); }
};

LogAxis timeAxis(const ComparisonState& state) {
  std::vector<double> values;
  for (const TrailPoint& p : state.points) values.insert(values.end(), {p.milliseconds.low, p.milliseconds.high});
  return LogAxis(values);
}

LogAxis errorAxis(const ComparisonState& state) {
  std::vector<double> values;
  for (const TrailPoint& p : state.points) values.insert(values.end(), {p.relMse.low, p.relMse.high});
  return LogAxis(values);
}

void drawGrid(const Plot& plot) {
  const ImU32 line = IM_COL32(255, 255, 255, 26);
  for (const double t : plot.x.ticks()) {
    const float x = plot.at(t, 0.0).x;
    const std::string text = fmt::format("{:.4g}", t);
    plot.draw.AddLine({x, plot.low.y}, {x, plot.high.y}, line);
    plot.draw.AddText({x - 0.5f * ImGui::CalcTextSize(text.c_str()).x, plot.high.y}, palette().faint, text.c_str());
  }
  for (const double t : plot.y.ticks()) {
    const float y = plot.at(0.0, t).y;
    const std::string text = fmt::format("{:.2g}", t);
    const ImVec2 size = ImGui::CalcTextSize(text.c_str());
    plot.draw.AddLine({plot.low.x, y}, {plot.high.x, y}, line);
    plot.draw.AddText({plot.low.x - size.x - 3.0f * plot.scale, y - 0.5f * size.y}, palette().faint, text.c_str());
  }
}

/// Below it lies what the reference's own noise hides.
void drawFloor(const Plot& plot, double relMse) {
  if (!std::isfinite(relMse) || !(relMse > plot.y.low())) return;
  const float y = plot.at(0.0, relMse).y;
  plot.draw.AddRectFilled({plot.low.x, y}, plot.high, IM_COL32(240, 110, 100, 30));
  plot.draw.AddLine({plot.low.x, y}, {plot.high.x, y}, palette().bad);
}

/// Steps: what a time at least as long can have as its least error.
void drawFront(const Plot& plot, const ComparisonState& state) {
  for (size_t i = 1; i < state.front.size(); ++i) {
    const ImVec2 from = plot.at(state.points[state.front[i - 1]]), to = plot.at(state.points[state.front[i]]);
    plot.draw.AddLine(from, {to.x, from.y}, palette().faint);
    plot.draw.AddLine({to.x, from.y}, to, palette().faint);
  }
}

void drawPoint(const Plot& plot, const TrailPoint& p, bool current, bool under) {
  const ImVec2 at = plot.at(p);
  const ImU32 color = current ? palette().accent : under ? palette().changed : palette().faint;
  if (current || under) {
    plot.draw.AddLine(plot.at(p.milliseconds.low, p.relMse.median), plot.at(p.milliseconds.high, p.relMse.median),
                      color);
    plot.draw.AddLine(plot.at(p.milliseconds.median, p.relMse.low), plot.at(p.milliseconds.median, p.relMse.high),
                      color);
  }
  plot.draw.AddCircleFilled(at, (current ? 5.0f : 3.5f) * plot.scale, color);
}

}  // namespace

int drawTrail(Ui& ui, const Rectangle& where, const ComparisonState& state) {
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const float line = ImGui::GetTextLineHeight();
  const ImVec2 low{where.low.x + 44.0f * ui.scale, where.low.y + 0.5f * line},
      high{where.high.x - 6.0f * ui.scale, where.high.y - 2.2f * line};
  if (high.x - low.x < 20.0f || high.y - low.y < 20.0f) return -1;
  const Plot plot{draw, low, high, timeAxis(state), errorAxis(state), ui.scale};
  draw.AddRectFilled(low, high, IM_COL32(14, 16, 19, 255), 2.0f);
  draw.AddText({low.x, high.y + 1.1f * line}, palette().faint, "GPU ms, and relMSE upwards");
  if (state.points.empty()) {
    draw.AddText({low.x + 6.0f * ui.scale, low.y + 4.0f * ui.scale}, palette().faint, "no point yet");
    return -1;
  }
  drawGrid(plot);
  draw.PushClipRect(low, high, true);
  drawFloor(plot, state.referenceRelMse);
  drawFront(plot, state);
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  int under = -1;
  float nearest = 8.0f * ui.scale;
  for (size_t i = 0; i < state.points.size() && ImGui::IsWindowHovered(); ++i) {
    const ImVec2 at = plot.at(state.points[i]);
    const float distance = std::hypot(at.x - mouse.x, at.y - mouse.y);
    if (distance >= nearest) continue;
    nearest = distance;
    under = static_cast<int>(i);
  }
  for (size_t i = 0; i < state.points.size(); ++i)
    drawPoint(plot, state.points[i], state.hasCurrent && i + 1 == state.points.size(), static_cast<int>(i) == under);
  draw.PopClipRect();
  for (size_t i = 0; i < state.points.size(); ++i) {
    const ImVec2 at = plot.at(state.points[i]);
    const glm::vec2 side(6.0f * ui.scale);
    ui.marks.place(fmt::format("point/{}", i), {glm::vec2(at.x, at.y) - side, glm::vec2(at.x, at.y) + side});
  }
  return under;
}

}  // namespace weir::view
