// `weir render`: frames of a graph over a scene, without a window, into files.
#pragma once

#include <weir/graph/description.h>
#include <weir/image/image.h>
#include <weir/render/stage.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace weir::render {

struct RenderOptions {
  std::string graph;
  graph::Overrides overrides;
  StageOptions stage;
  uint32_t width = 1280, height = 720;
  uint32_t frames = 1;      ///< 0 … frames-1 in sequence
  uint32_t average = 1;     ///< outputs are the mean of the last so many
  uint32_t restarts = 1;    ///< repeats with independent seeds and cleared history; outputs are the mean over them
  uint32_t firstFrame = 0;  ///< number of the first frame
  uint32_t seed = 0;
  std::vector<std::pair<std::string, std::string>> outputs;  ///< graph output → file (.exr or .png)
  std::vector<std::pair<std::string, std::string>>
      errors;                     ///< graph output → file with the standard error over restarts
  std::optional<float> exposure;  ///< EV, for every output.Tonemap
  std::string trace = "auto";
  std::string device;
  std::string statistics;  ///< JSON file
  std::vector<std::string> pluginPaths;
  bool validation = false;
  /// Called now and then with the frames done and all frames there are.
  std::function<void(uint64_t, uint64_t)> progress;
  std::function<void(const std::string&)> warn;
};

/// Seed of a restart: independent of its neighbours', restart 0 keeps the given one.
uint32_t restartSeed(uint32_t seed, uint32_t restart);

/// Checks everything that can be checked before any work, renders, writes. Throws InputError, graph::GraphError,
/// RuntimeError.
void render(const RenderOptions& options);

}  // namespace weir::render
