// Graphs of any length that look like real ones, for measuring: blocks of ten passes, each a small renderer with
// buffers and images, several ports and parameters a pass, diamonds, half and quarter sizes, history, an optional
// input left open, a disabled pass and one that nothing reads.
#pragma once

#include <weir/graph/compile.h>

#include <string>
#include <unordered_map>

namespace weir::bench {

/// What stands for the plugins. Looked up by hash, as a catalog of a running program may be; keep it alive while its
/// PassCatalog is in use.
class SyntheticPasses {
 public:
  SyntheticPasses();
  graph::PassCatalog catalog() const;

 private:
  PassDescription& add(const char* type);
  std::unordered_map<std::string, PassDescription> types_;
};

/// Passes a block of the graph.
inline constexpr int kBlock = 10;
/// Of these, how many run: one is disabled and one is read by nothing.
inline constexpr int kRunning = 8;

/// The JSON of a graph of `passes` passes, a multiple of kBlock. Keys are in an order of their own, not in that of the
/// frame.
std::string syntheticGraph(int passes);

}  // namespace weir::bench
