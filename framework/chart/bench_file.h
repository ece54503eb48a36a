// What `weir bench` measured, read back and checked: docs/bench.md has the format.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace weir::chart {

inline constexpr double kNone = std::numeric_limits<double>::quiet_NaN();  ///< of a figure: was not measured

/// Milliseconds.
struct Times {
  double median = kNone, p95 = kNone;
};

/// A figure and its 95 % confidence interval; low and high may be kNone.
struct Interval {
  double value = kNone, low = kNone, high = kNone;
};

struct PassTimes {
  std::string name, type;
  Times gpu;
};

/// Of one configuration; absolute, existing files inside the bench file's folder, or empty.
struct PicturePaths {
  std::string frame, reference, flip;
};

struct Configuration {
  size_t file = 0;  ///< index in Bench::files
  std::string id, graph, name;
  std::string scene, digest, lights, camera, animation;
  uint32_t width = 0, height = 0;  ///< pixels
  Times frame, wall;
  std::vector<PassTimes> passes;
  std::map<std::string, Interval> errors;  ///< by the names of errorMeasures(); only those that were measured
  PicturePaths pictures;
  std::string json;  ///< all that the page shows, one JSON object, made of known and checked members only
};

struct BenchFile {
  std::string path, device, driver, trace, weir;
};

struct Bench {
  std::vector<BenchFile> files;
  std::vector<Configuration> configurations;
  std::vector<std::string> warnings;  ///< pictures that are missing, configurations that are there twice
};

/// How a bench file calls an error, and its parts: "relmse.median", "relmse_mean64", … in the order of the page.
const std::vector<std::string>& errorMeasures();

/// A configuration of several files, or twice in one, is taken once when all of it is the same; else each of them is
/// kept and a warning says so. Throws InputError that names the file and the place in it: no such file, no JSON,
/// another version, a missing member, a wrong type, a figure that can't be (a negative time), a picture outside of the
/// file's folder.
Bench readBench(const std::vector<std::string>& paths);

}  // namespace weir::chart
