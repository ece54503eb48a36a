// Times of many frames in a few figures, and the JSON of `--stats`.
#pragma once

#include <weir/execute/executor.h>

#include <string>
#include <vector>

namespace weir::render {

struct Quantiles {
  double median = 0.0, p95 = 0.0, p99 = 0.0;
};
/// By linear interpolation between order statistics; zeros for no values.
Quantiles quantiles(std::vector<double> values);

struct RunFacts {
  std::string device, driver, trace, scene, lights, animation;
  double importSeconds = 0.0, prepareSeconds = 0.0, uploadSeconds = 0.0, compileSeconds = 0.0;
  uint64_t sceneBytes = 0, transientBytes = 0, historyBytes = 0;
  uint64_t rays = 0;  ///< of one frame
};

/// Frames from the first tenth on (at least one) are left out as warm-up when there are three or more.
std::string statisticsJson(const graph::CompiledGraph& graph, const std::vector<execute::FrameTimes>& times,
                           const RunFacts& facts);

}  // namespace weir::render
