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
  const graph::CompiledGraph& graph;  ///< as it ran on this device, with scratch resources
  double frameGpuMs = 0;              ///< median
  uint64_t rays = 0;                  ///< of a frame
  uint32_t warmup = 0, frames = 0;    ///< to measure with
};

using FloorFunction = std::function<std::optional<Floor>(const FloorInput&)>;

}  // namespace weir::render
