// What was measured of one configuration, and its JSON in the bench file (docs/bench.md).
#pragma once

#include <weir/image/interval.h>
#include <weir/render/bench_floor.h>
#include <weir/render/bench_options.h>
#include <weir/render/statistics.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace weir::render {

struct PassMeasure {
  std::string name, type;
  std::optional<Quantiles> gpuMs;            ///< none where the device has no timestamps
  double cpuMs = 0;                          ///< median time to record it
  uint64_t bytesRead = 0, bytesWritten = 0;  ///< of its declared ports, each once
};

/// Of the timed frames.
struct CostMeasure {
  std::vector<PassMeasure> passes;
  std::optional<Quantiles> frameGpuMs;
  double frameCpuMs = 0;  ///< median time to record and submit
  double wallMs = 0;      ///< whole loop / frames
  uint64_t transientBytes = 0, historyBytes = 0, sceneBytes = 0, savedBytes = 0;
  uint64_t rays = 0;  ///< of a frame
};

struct ErrorMeasure {
  uint32_t repeats = 0, frames = 0, every = 1;
  std::string reference;       ///< in words
  bool exact = false;          ///< the reference has no error of its own, by word or by its restarts' agreement
  double referenceRelMse = 0;  ///< what its own error adds to each relMSE; NaN: unknown
  image::Interval frameMedian, frameMean, frameTrimmed;                   ///< relMSE of one frame
  std::vector<std::pair<uint32_t, image::Interval>> means, trimmedMeans;  ///< of the first N frames' mean, by N
  std::optional<image::Interval> flip;
  image::Interval bias, correlationTime;
  uint64_t nonFinite = 0;  ///< pixels, over all compared frames
};

/// File names relative to the bench file's folder.
struct PictureNames {
  Crop crop{};
  std::string frame, reference, flip;
};

struct BenchRecord {
  std::string id, graph, name, command;
  std::string sceneFile, sceneDigest, lights, camera, animation;
  uint32_t width = 0, height = 0, frames = 0, warmup = 0;
  std::map<std::string, ParamValue> settings, parameters;
  CostMeasure cost;
  std::optional<Floor> floor;
  std::optional<ErrorMeasure> error;
  std::optional<PictureNames> pictures;
};

/// One element of "configurations".
std::string recordJson(const BenchRecord& record);

}  // namespace weir::render
