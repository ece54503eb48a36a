// The chart as a still picture, drawn without a browser.
#pragma once

#include <weir/chart/axes.h>

#include <string>

namespace weir::chart {

struct View {
  std::string title;
  Axis time, error;
};

/// One panel a group, one below the other: points by graph, error bars, Pareto front, lines of equal time × error. A
/// complete SVG 1.1 document with light colours, text as text, a title and a description for screen readers. A group
/// without points says so.
std::string drawSvg(const Bench& bench, const View& view);

/// Text that means nothing to XML or HTML, in content and in quoted attributes. Characters that XML 1.0 can't hold
/// become U+FFFD.
std::string escapeXml(const std::string& text);

}  // namespace weir::chart
