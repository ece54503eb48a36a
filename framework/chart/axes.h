// What the two axes of the chart can show, and which configurations can be compared with each other.
#pragma once

#include <weir/chart/bench_file.h>

#include <string>
#include <vector>

namespace weir::chart {

struct Axis {
  std::string key, label;
};

/// Of a frame, in ms: "frame" (GPU), "no-gbuffer" (GPU, without passes of types gbuffer.*), "wall", then "pass.NAME" of
/// every pass that was measured anywhere.
std::vector<Axis> timeAxes(const Bench& bench);
/// Every one of errorMeasures().
std::vector<Axis> errorAxes();

/// The median, and up to the 95th percentile where there is one: not of "no-gbuffer", as percentiles don't subtract.
Interval timeOf(const Configuration& c, const std::string& key);
/// With its confidence interval. Of "bias" the absolute value; an interval that holds zero reaches down to it.
Interval errorOf(const Configuration& c, const std::string& key);

/// `given` when there is such an axis; when it is empty the first one that any configuration has a figure for.
/// InputError that names the nearest axis.
Axis chooseTime(const Bench& bench, const std::string& given);
Axis chooseError(const Bench& bench, const std::string& given);

/// Configurations of one scene (by its digest, where there is one) with its lights, camera, animation and size on one
/// device: a Pareto front is drawn among these only.
struct Group {
  std::string label;  ///< the scene's file, and what else sets this group apart; no two are the same
  std::vector<size_t> configurations;
};
/// Of a bench that has configurations.
std::vector<Group> groups(const Bench& bench);

struct Point {
  size_t configuration = 0;  ///< index in Bench::configurations
  Interval time, error;
};
/// Those that log axes can show: both figures there and above zero. An interval's end that isn't above zero is kNone.
std::vector<Point> points(const Bench& bench, const Group& group, const std::string& time, const std::string& error);

/// Of each point whether none other is at least as good in both and better in one.
std::vector<bool> paretoFront(const std::vector<Point>& points);

}  // namespace weir::chart
