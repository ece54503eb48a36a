// What the hardware must spend on a configuration at the least: how a bench asks for it, and what it gets.
#pragma once

#include <weir/graph/compile.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace weir::render {

class Laboratory;
struct BenchSettings;

struct FloorPart {
  std::string name;  ///< "gbuffer rays", …
  double gpuMs = 0;
};

struct Floor {
  double gpuMs = 0;     ///< sum of the parts, a frame
  double multiple = 0;  ///< median GPU time of a frame / gpuMs
  std::vector<FloorPart> parts;
};

/// What is known of a configuration when its floor is measured.
struct FloorInput {
  Laboratory& laboratory;             ///< open, nothing of the configuration in flight
  const std::string& file;            ///< the graph's
  const graph::Overrides& overrides;  ///< what was set in it
  const graph::CompiledGraph& graph;  ///< as it ran on this device, with scratch resources
  const BenchSettings& settings;      ///< frames to warm up with and to measure
  double frameGpuMs = 0;              ///< median
  uint64_t rays = 0;                  ///< of a frame
};

using FloorFunction = std::function<std::optional<Floor>(const FloorInput&)>;

/// Runs the configuration's graph with passes of the plugin `floor` beside its own, that trace the same rays and
/// nothing else and read and write the bytes of its buffers once. Camera rays count as those of gbuffer.RayTraced; each
/// other ray costs what the shadow rays of the graph's reservoirs cost in the mean, all its buffers what as many words
/// cost. None on devices without timestamps. Throws RuntimeError, graph::GraphError.
std::optional<Floor> measureFloor(const FloorInput& in);

}  // namespace weir::render
