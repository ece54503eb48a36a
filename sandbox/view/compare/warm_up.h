// How many frames after a change do not yet show what the new setting does.
#pragma once

#include <weir/graph/compile.h>

#include <cstdint>
#include <string>

namespace weir::view {

struct WarmUp {
  uint64_t frames = 0;
  std::string reason;  ///< a clause
};

/// Without history: those in flight when it changed. With history: twice as many as the longest memory that a parameter
/// of a pass that reads the past states in frames; a usual length where none does.
WarmUp warmUpOf(const graph::CompiledGraph& graph);

}  // namespace weir::view
