// How many restarts of a graph run at a time: small pictures leave most of a GPU idle, and a frame costs the host the
// same whether one restart is in it or sixteen.
#pragma once

#include <weir/gpu/device.h>
#include <weir/graph/compile.h>

#include <cstdint>
#include <string>

namespace weir::render {

/// `--lanes`: "auto" is 0, else a number from 1 to execute::SceneFrame::kMostLanes. InputError.
uint32_t parseLanes(const std::string& words);

/// What "auto" stands for: on a CPU 1, else as many as together have four million pixels, 16 at most, and no more than
/// a quarter of the device's free memory holds (scratch memory of the passes, which is not known yet, needs some too).
uint32_t lanesThatFill(const gpu::Device& device, const graph::CompiledGraph& graph);

}  // namespace weir::render
