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

class Placer {
 public:
  Placer(CompiledGraph& graph, const std::vector<MemoryNeed>& needs, uint64_t largest)
      : graph_(graph), needs_(needs), largest_(largest) {}

  void place(uint32_t index) {
    for (uint32_t b = 0; b < graph_.blocks.size(); ++b)
      if ((graph_.blocks[b].kinds & needs_[index].kinds) != 0 && placeIn(b, index)) return;
    graph_.blocks.push_back({0, 1, 0xffffffffu});
    placed_.emplace_back();
    placeIn(static_cast<uint32_t>(graph_.blocks.size() - 1), index);
  }

  /// Says of each resource whether others use some of its memory.
  void markShared() {
    for (const std::vector<Place>& block : placed_)
      for (size_t i = 0; i < block.size(); ++i)
        for (size_t k = i + 1; k < block.size() && block[k].from < block[i].to; ++k)
          graph_.resources[block[i].resource].shares = graph_.resources[block[k].resource].shares = true;
  }

 private:
  /// All that looking for a gap needs, side by side in memory.
  struct Place {
    uint64_t from, to;
    uint32_t firstUse, lastUse, resource;
  };

  bool placeIn(uint32_t b, uint32_t index) {
    Resource& r = graph_.resources[index];
    const MemoryNeed& need = needs_[index];
    std::vector<Place>& places = placed_[b];
    uint64_t at = 0;
    for (const Place& other : places) {  // by offset, so that the first gap is the lowest
      if (other.firstUse > r.lastUse || r.firstUse > other.lastUse) continue;
      if (at + need.bytes <= other.from) break;
      at = std::max(at, alignedUp(other.to, need.alignment));
    }
    MemoryBlock& block = graph_.blocks[b];
    if (!places.empty() && at + need.bytes > std::max(block.bytes, largest_)) return false;
    block.bytes = std::max(block.bytes, at + need.bytes);
    block.alignment = std::max(block.alignment, need.alignment);
    block.kinds &= need.kinds;
    r.block = b;
    r.offset = at;
    const auto after = std::find_if(places.begin(), places.end(), [at](const Place& other) { return other.from > at; });
    places.insert(after, {at, at + need.bytes, r.firstUse, r.lastUse, index});
    return true;
  }

  CompiledGraph& graph_;
  const std::vector<MemoryNeed>& needs_;
  uint64_t largest_;
  std::vector<std::vector<Place>> placed_;  ///< by block, ascending offsets
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
  placer.markShared();
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

uint64_t CompiledGraph::transientBytes() const {
  uint64_t sum = sharedBytes();
  for (const Resource& r : resources)
    if (r.transient() && r.block == kNone) sum += r.memoryBytes;
  return sum;
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
