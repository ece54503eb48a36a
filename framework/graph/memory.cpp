// Which transient resources share memory. A resource is an interval of passes and a size; placing intervals so that
// those that overlap in time lie apart is dynamic storage allocation. Greedy by size, each at the lowest place that is
// free for all of its life, stays within a few percent of the most bytes alive at once on graphs like ours; `weir graph
// explain` prints both.
#include <weir/graph/compile.h>

#include <algorithm>
#include <numeric>

namespace weir::graph {

bool shareMemory(const Resource& a, const Resource& b) {
  return a.block != kNone && a.block == b.block && a.offset < b.offset + b.memoryBytes &&
         b.offset < a.offset + a.memoryBytes;
}

namespace {

uint64_t alignedUp(uint64_t value, uint64_t alignment) {
  return (value + alignment - 1) / alignment * alignment;
}

bool livesWith(const Resource& a, const Resource& b) {
  return a.firstUse <= b.lastUse && b.firstUse <= a.lastUse;
}

class Placer {
 public:
  Placer(CompiledGraph& graph, const std::vector<MemoryNeed>& needs, uint64_t largest)
      : graph_(graph), needs_(needs), largest_(largest) {}

  void place(uint32_t index) {
    Resource& r = graph_.resources[index];
    for (uint32_t b = 0; b < graph_.blocks.size(); ++b)
      if ((graph_.blocks[b].kinds & needs_[index].kinds) != 0 && placeIn(b, index)) return;
    graph_.blocks.push_back({needs_[index].bytes, needs_[index].alignment, needs_[index].kinds});
    placed_.emplace_back().push_back(index);
    r.block = static_cast<uint32_t>(graph_.blocks.size() - 1);
    r.offset = 0;
  }

 private:
  bool placeIn(uint32_t b, uint32_t index) {
    Resource& r = graph_.resources[index];
    const MemoryNeed& need = needs_[index];
    uint64_t at = 0;
    for (const uint32_t other : placed_[b]) {  // by offset, so that the first gap is the lowest
      const Resource& o = graph_.resources[other];
      if (!livesWith(o, r)) continue;
      if (at + need.bytes <= o.offset) break;
      at = std::max(at, alignedUp(o.offset + needs_[other].bytes, need.alignment));
    }
    MemoryBlock& block = graph_.blocks[b];
    if (at + need.bytes > std::max(block.bytes, largest_)) return false;
    block.bytes = std::max(block.bytes, at + need.bytes);
    block.alignment = std::max(block.alignment, need.alignment);
    block.kinds &= need.kinds;
    r.block = b;
    r.offset = at;
    const auto byOffset = [this](uint64_t offset, uint32_t other) { return offset < graph_.resources[other].offset; };
    placed_[b].insert(std::upper_bound(placed_[b].begin(), placed_[b].end(), at, byOffset), index);
    return true;
  }

  CompiledGraph& graph_;
  const std::vector<MemoryNeed>& needs_;
  uint64_t largest_;
  std::vector<std::vector<uint32_t>> placed_;  ///< by block, ascending offsets
};

}  // namespace

std::vector<MemoryNeed> logicalNeeds(const CompiledGraph& graph) {
  constexpr uint64_t kAlignment = 256;  // what Vulkan devices commonly ask for
  std::vector<MemoryNeed> needs;
  needs.reserve(graph.resources.size());
  for (const Resource& r : graph.resources) needs.push_back({alignedUp(r.bytes, kAlignment), kAlignment});
  return needs;
}

void planMemory(CompiledGraph& graph, const std::vector<MemoryNeed>& needs, bool share, uint64_t largest) {
  graph.blocks.clear();
  std::vector<uint32_t> order;
  for (uint32_t r = 0; r < graph.resources.size(); ++r) {
    graph.resources[r].block = kNone;
    graph.resources[r].offset = 0;
    graph.resources[r].shares = false;
    graph.resources[r].memoryBytes = needs[r].bytes;
    if (share && graph.resources[r].transient()) order.push_back(r);
  }
  // Ties by index, so that equal graphs give equal plans.
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return needs[a].bytes > needs[b].bytes; });
  Placer placer(graph, needs, largest);
  for (const uint32_t r : order) placer.place(r);
  for (size_t i = 0; i < order.size(); ++i)
    for (size_t k = 0; k < i; ++k) {
      Resource &a = graph.resources[order[i]], &b = graph.resources[order[k]];
      if (shareMemory(a, b)) a.shares = b.shares = true;
    }
}

uint64_t CompiledGraph::mostAlive() const {
  uint64_t most = 0;
  for (uint32_t pass = 0; pass < passes.size(); ++pass) {
    uint64_t alive = 0;
    for (const Resource& r : resources)
      if (r.transient() && r.firstUse <= pass && pass <= r.lastUse) alive += r.memoryBytes;
    most = std::max(most, alive);
  }
  return most;
}

uint64_t CompiledGraph::sharedBytes() const {
  return std::accumulate(blocks.begin(), blocks.end(), uint64_t{0},
                         [](uint64_t sum, const MemoryBlock& block) { return sum + block.bytes; });
}

uint64_t CompiledGraph::separateBytes() const {
  uint64_t sum = 0;
  for (const Resource& r : resources)
    if (r.transient()) sum += r.memoryBytes;
  return sum;
}

uint64_t CompiledGraph::historyBytes() const {
  uint64_t sum = 0;
  for (const Resource& r : resources)
    if (r.history) sum += 2 * r.memoryBytes;
  return sum;
}

}  // namespace weir::graph
