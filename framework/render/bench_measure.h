// What a configuration costs: times of frames, memory, rays, and the bytes that its ports carry.
#pragma once

#include <weir/execute/executor.h>
#include <weir/render/bench_options.h>
#include <weir/render/bench_record.h>
#include <weir/render/stage.h>

#include <cstdint>
#include <vector>

namespace weir::render {

/// Warm-up frames from cleared history, then timed frames, without captures. Rays and scene bytes are left at 0.
CostMeasure measureCost(execute::Executor& executor, const Stage& stage, const BenchSettings& settings);

/// Rays of a frame whose history has its usual length. The executor must count rays.
uint64_t countRays(execute::Executor& counting, const Stage& stage, const BenchSettings& settings);

/// Times of so many last frames in figures; `passes` are the graph's. Bytes are those of declared ports: each input
/// and output once, one copy, whatever the pass really touches of it.
std::vector<PassMeasure> passMeasures(const graph::CompiledGraph& graph, const std::vector<execute::FrameTimes>& times);

}  // namespace weir::render
