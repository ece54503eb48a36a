// `weir bench`: what configurations cost and how far their pictures are from the truth, one after the other on one
// device, into a file that grows with each. docs/bench.md is the manual.
#pragma once

#include <weir/render/bench_options.h>
#include <weir/render/bench_record.h>

#include <cstddef>
#include <functional>

namespace weir::render {

struct BenchOutcome {
  size_t planned = 0;   ///< configurations of all shards, each once
  size_t own = 0;       ///< of this shard
  size_t there = 0;     ///< of these, that the file had already
  size_t measured = 0;  ///< now
};

/// Checks everything that can be checked before any work; then measures what the file lacks. `done` is called with each
/// configuration when it is in the file. Throws InputError, graph::GraphError, RuntimeError; what was measured until
/// then stays.
BenchOutcome bench(const BenchOptions& options, const std::function<void(const BenchRecord&)>& done = {});

}  // namespace weir::render
