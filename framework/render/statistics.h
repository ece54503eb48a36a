// Times of many frames in a few figures, and the JSON of `--stats`.
#pragma once

#include <weir/execute/executor.h>
#include <weir/scene/import.h>

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
  scene::ImportTimes importTimes;
  double prepareSeconds = 0.0, uploadSeconds = 0.0, accelerationSeconds = 0.0, compileSeconds = 0.0;
  double firstFrameSeconds = 0.0;  ///< from the start to the end of the first frame
  uint64_t peakHostBytes = 0;      ///< most memory that the process has had
  uint64_t sceneBytes = 0, transientBytes = 0, savedBytes = 0, historyBytes = 0;
  uint64_t rays = 0;  ///< of one frame
  struct Environment {
    std::string file;                                       ///< empty: none
    uint32_t width = 0, height = 0, columns = 0, rows = 0;  ///< of the picture and of the table that picks from it
    double integral = 0.0;                                  ///< ∫ luminance dω, nit · sr
    double share = 0.0;                                     ///< of the candidates that are picked by power
    double seconds = 0.0;                                   ///< to read it
  } environment;
};

/// Frames from the first tenth on (at least one) are left out as warm-up when there are three or more.
std::string statisticsJson(const graph::CompiledGraph& graph, const std::vector<execute::FrameTimes>& times,
                           const RunFacts& facts);

}  // namespace weir::render
