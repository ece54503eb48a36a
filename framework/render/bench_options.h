// What a bench is asked to do: configurations (graphs × sweeps over scenes), and how each is measured.
#pragma once

#include <weir/graph/description.h>
#include <weir/render/bench_floor.h>
#include <weir/render/laboratory.h>
#include <weir/render/stage.h>

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace weir::render {

/// `--sweep pass.param=a,b,c`; the parameter "enabled" is the pass's toggle.
struct Sweep {
  std::string pass, param;
  std::vector<std::string> values;
  bool isToggle() const { return param == "enabled"; }
  std::string name() const { return pass + "." + param; }
};
/// Throws InputError naming the text: no pass.param=…, an empty or repeated value, a toggle that is not true or false.
Sweep parseSweep(const std::string& text);

/// What pictures are compared with.
struct BenchReference {
  std::string file;            ///< EXR or Radiance HDR
  bool exact = false;          ///< it has no error of its own, as a closed form
  std::string graph;           ///< rendered here instead: "radiance" of this graph, mean over frames and restarts
  graph::Overrides overrides;  ///< in that graph
  uint32_t frames = 1, restarts = 2;
  bool wanted() const { return !file.empty() || !graph.empty(); }
};

/// Graphs over one scene, with every combination of the sweeps' values.
struct BenchPart {
  std::string name;  ///< of the sweep in a plan; empty on the command line
  std::vector<std::string> graphs;
  StageOptions stage;
  uint32_t width = 1920, height = 1080;
  graph::Overrides overrides;  ///< in all of them
  std::vector<Sweep> sweeps;
  BenchReference reference;
};

using Crop = std::array<uint32_t, 4>;  ///< x, y, width, height in pixels

/// How each configuration is measured.
struct BenchSettings {
  uint32_t warmup = 40, frames = 100;  ///< before and while times are taken
  uint32_t firstFrame = 0, seed = 0;
  uint32_t repeats = 4;        ///< independent restarts that errors are taken from; 12 + 8 bytes a pixel and repeat
  uint32_t errorFrames = 256;  ///< of each, after `warmup`
  uint32_t errorEvery = 1;     ///< one frame of so many is compared by itself; means are of all
  std::string output = "radiance";
  bool flip = true;
  std::optional<Crop> crop;  ///< none: 256×256 in the middle, or the whole of a smaller picture
};

struct BenchOptions {
  std::vector<BenchPart> parts;
  BenchSettings settings;
  DeviceChoice device;
  std::vector<std::string> pluginPaths;
  std::string plan;                ///< file that the parts are from; empty: the command line
  std::string out;                 ///< FILE.json
  bool fresh = false;              ///< what FILE.json has is measured anew
  uint32_t shard = 0, shards = 1;  ///< every `shards`-th configuration from `shard` on
  FloorFunction floor;             ///< measured after the times of each configuration; none: not at all
  /// What is being measured, its number from 1, and how many there are.
  std::function<void(const std::string&, size_t, size_t)> progress;
  std::function<void(const std::string&)> warn;
};

}  // namespace weir::render
