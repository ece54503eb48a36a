// What each pass waits for, in a frame that follows another frame of the same graph.
//
// A resource has one producer, which writes it before anybody reads it in the frame. So a copy goes through these
// phases:
//
//   without history      | write ─► reads                       | write (next frame) …
//   with, two copies     | write ─► reads ─► reads as previous  | write (the frame after the next) …
//
// and where memory is shared, the last reads of whoever had it stand before the write too.
//
// A memory barrier is global: it holds for everything that its stages did, not for one resource. So a dependency from
// pass A to pass B is an interval of time, a barrier a point in it, and the fewest barriers are the fewest points that
// every interval contains one of: going through the frame, one is placed where an interval ends that has none yet.
#include <weir/graph/checked.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <tuple>
#include <utility>

namespace weir::graph {
namespace {

constexpr std::array<Stages, 3> kStages = {kComputeStage, kRayStage, kRasterStage};

/// Lists the dependencies of every pass.
class Hazards {
 public:
  explicit Hazards(CompiledGraph& graph) : graph_(graph), readers_(graph.resources.size()), later_(readers_.size()) {
    for (uint32_t p = 0; p < graph.passes.size(); ++p)
      for (const Binding& input : graph.passes[p].inputs)
        if (input.resource != kNone) addOnce((input.previous ? later_ : readers_)[input.resource], p);
    sharing_.resize(graph.blocks.size());
    for (uint32_t r = 0; r < graph.resources.size(); ++r)
      if (graph.resources[r].shares) sharing_[graph.resources[r].block].push_back(r);
    for (std::vector<uint32_t>& block : sharing_)
      std::sort(block.begin(), block.end(),
                [&](uint32_t a, uint32_t b) { return graph.resources[a].offset < graph.resources[b].offset; });
  }

  void list(uint32_t pass) {
    CompiledPass& p = graph_.passes[pass];
    p.dependencies.clear();
    for (const Binding& input : p.inputs) {
      if (input.resource == kNone) continue;
      const uint32_t producer = graph_.resources[input.resource].producer;
      if (producer != kNone)
        p.dependencies.push_back(
            {Hazard::ReadAfterWrite, input.resource, input.resource, producer, input.previous ? 1u : 0u});
    }
    for (const Binding& output : p.outputs) beforeWriting(p, output.resource);
    for (const uint32_t scratch : p.scratch) beforeWriting(p, scratch);
  }

 private:
  static void addOnce(std::vector<uint32_t>& list, uint32_t pass) {
    if (list.empty() || list.back() != pass) list.push_back(pass);
  }

  void beforeWriting(CompiledPass& p, uint32_t resource) {
    const Resource& r = graph_.resources[resource];
    if (r.external) return;  // the host comes before and after
    if (r.shares) return takeOver(p, resource);
    usesOf(p, resource, resource, r.history ? 2 : 1);
    for (const uint32_t reader : later_[resource])
      p.dependencies.push_back({Hazard::WriteAfterRead, resource, resource, reader, 1});
  }

  /// Who had some of the memory, last first, until every byte is accounted for: those before them are over too, as the
  /// later ones waited for them.
  void takeOver(CompiledPass& p, uint32_t resource) {
    const Resource& r = graph_.resources[resource];
    struct Owner {
      uint32_t resource, framesBack;
      int64_t lastUse;  ///< in passes since this frame began
    };
    std::vector<Owner> owners;
    for (const uint32_t other : sharing_[r.block]) {
      const Resource& o = graph_.resources[other];
      if (o.offset >= r.offset + r.memoryBytes) break;
      if (!shareMemory(r, o)) continue;
      const bool thisFrame = other != resource && o.lastUse < r.firstUse;
      const auto passes = static_cast<int64_t>(graph_.passes.size());
      owners.push_back({other, thisFrame ? 0u : 1u, thisFrame ? int64_t{o.lastUse} : int64_t{o.lastUse} - passes});
    }
    std::sort(owners.begin(), owners.end(), [](const Owner& a, const Owner& b) {
      return std::tie(b.lastUse, a.resource) < std::tie(a.lastUse, b.resource);
    });
    std::vector<Range> open = {{r.offset, r.offset + r.memoryBytes}};
    for (const Owner& owner : owners) {
      const Resource& o = graph_.resources[owner.resource];
      if (take(open, {o.offset, o.offset + o.memoryBytes})) usesOf(p, resource, owner.resource, owner.framesBack);
      if (open.empty()) return;
    }
  }

  struct Range {
    uint64_t from, to;
  };
  /// Takes `range` out of `open`; whether any of it was there.
  static bool take(std::vector<Range>& open, const Range& range) {
    std::vector<Range> left;
    bool any = false;
    for (const Range& part : open) {
      const Range both{std::max(part.from, range.from), std::min(part.to, range.to)};
      if (both.from >= both.to) {
        left.push_back(part);
        continue;
      }
      any = true;
      if (part.from < both.from) left.push_back({part.from, both.from});
      if (both.to < part.to) left.push_back({both.to, part.to});
    }
    open = std::move(left);
    return any;
  }

  /// All uses of `had` in that frame must be over before `wanted` is written.
  void usesOf(CompiledPass& p, uint32_t wanted, uint32_t had, uint32_t framesBack) {
    // Reads came after a barrier that made the write visible, so that once they are over the write is too.
    for (const uint32_t reader : readers_[had])
      p.dependencies.push_back({Hazard::WriteAfterRead, wanted, had, reader, framesBack});
    if (readers_[had].empty() && (later_[had].empty() || wanted != had))
      p.dependencies.push_back({Hazard::WriteAfterWrite, wanted, had, graph_.resources[had].producer, framesBack});
  }

  CompiledGraph& graph_;
  std::vector<std::vector<uint32_t>> readers_, later_;  ///< by resource: passes that read it, now and as previous
  std::vector<std::vector<uint32_t>> sharing_;          ///< by block, by offset
};

/// An image that takes over memory has a barrier of its own, which covers all that it depends on.
void startImages(CompiledGraph& graph, CompiledPass& p) {
  p.starts.clear();
  for (Dependency& d : p.dependencies) {
    const Resource& r = graph.resources[d.resource];
    if (d.hazard == Hazard::ReadAfterWrite || !r.shares || !r.isImage()) continue;
    d.covered = true;
    if (p.starts.empty() || p.starts.back().resource != d.resource) p.starts.push_back({d.resource});
    p.starts.back().from |= graph.passes[d.pass].stages;
    p.starts.back().writes |= d.hazard == Hazard::WriteAfterWrite;
  }
}

/// Times count passes since the first frame; a barrier at time t stands before the pass of that time.
using Time = int64_t;
constexpr Time kNever = std::numeric_limits<Time>::min();

/// Barriers from one stage to another. Each stronger kind orders as well.
struct Last {
  Time order = kNever, read = kNever, write = kNever;
};

class Placement {
 public:
  explicit Placement(CompiledGraph& graph) : graph_(graph), passes_(static_cast<Time>(graph.passes.size())) {}

  /// The barriers of one frame, given those of the frames before it. True when they are the same as the frame before's.
  bool frame() {
    bool same = true;
    for (uint32_t p = 0; p < graph_.passes.size(); ++p) {
      std::vector<Wait> before = std::move(graph_.passes[p].waits);
      place(p);
      same = same && before == graph_.passes[p].waits;
    }
    ++frame_;
    return same;
  }
  void forget() { last_ = {}; }

 private:
  Time time(uint32_t pass, uint32_t framesBack) const { return (frame_ - framesBack) * passes_ + pass; }

  void place(uint32_t index) {
    CompiledPass& p = graph_.passes[index];
    p.waits.clear();
    const Time now = time(index, 0);
    // Barriers that carry data first: they order too, so that what only needs order finds it done.
    for (const bool carries : {true, false})
      for (Dependency& d : p.dependencies) {
        if ((d.hazard != Hazard::WriteAfterRead) != carries || isStart(d)) continue;
        d.covered = true;
        for (size_t from = 0; from < kStages.size(); ++from)
          for (size_t to = 0; to < kStages.size(); ++to)
            if ((graph_.passes[d.pass].stages & kStages[from]) != 0 && (p.stages & kStages[to]) != 0)
              d.covered &= contains(d, last_[from][to], now) || !add(p, d.hazard, from, to, now);
      }
    merge(p);
  }

  bool isStart(const Dependency& d) const {
    const Resource& r = graph_.resources[d.resource];
    return d.hazard != Hazard::ReadAfterWrite && r.shares && r.isImage();
  }

  /// Whether there is a barrier within the dependency, of an earlier pass or of this one.
  bool contains(const Dependency& d, const Last& last, Time now) const {
    const Time after = time(d.pass, d.framesBack), at = d.hazard == Hazard::ReadAfterWrite    ? last.read
                                                        : d.hazard == Hazard::WriteAfterWrite ? last.write
                                                                                              : last.order;
    return at > after && at < now;
  }

  /// Always true: the barrier stands before this very pass, so that the dependency is not covered by another's.
  bool add(CompiledPass& p, Hazard hazard, size_t from, size_t to, Time now) {
    Last& last = last_[from][to];
    const bool order = hazard == Hazard::WriteAfterRead;
    if (order && last.order == now) return true;
    last.order = now;
    if (hazard == Hazard::ReadAfterWrite) last.read = now;
    if (hazard == Hazard::WriteAfterWrite) last.write = now;
    p.waits.push_back(
        {kStages[from], kStages[to], !order, hazard == Hazard::ReadAfterWrite, hazard == Hazard::WriteAfterWrite});
    return true;
  }

  /// One barrier for each set of stages that waits in the same way.
  static void merge(CompiledPass& p) {
    std::vector<Wait> merged;
    const auto into = [&](const Wait& w, auto alike, auto join) {
      const auto found = std::find_if(merged.begin(), merged.end(), [&](const Wait& m) { return alike(m, w); });
      if (found == merged.end())
        merged.push_back(w);
      else
        join(*found, w);
    };
    for (const Wait& w : p.waits)
      into(
          w, [](const Wait& m, const Wait& o) { return m.from == o.from && m.to == o.to; },
          [](Wait& m, const Wait& o) {
            m.writes |= o.writes;
            m.toReads |= o.toReads;
            m.toWrites |= o.toWrites;
          });
    std::vector<Wait> atoms = std::move(merged);
    merged.clear();
    for (const Wait& w : atoms)
      into(
          w,
          [](const Wait& m, const Wait& o) {
            return std::tie(m.to, m.writes, m.toReads, m.toWrites) == std::tie(o.to, o.writes, o.toReads, o.toWrites);
          },
          [](Wait& m, const Wait& o) { m.from |= o.from; });
    p.waits = std::move(merged);
  }

  CompiledGraph& graph_;
  Time passes_, frame_ = 0;
  std::array<std::array<Last, kStages.size()>, kStages.size()> last_{};
};

}  // namespace

void planBarriers(CompiledGraph& graph) {
  Hazards hazards(graph);
  for (uint32_t p = 0; p < graph.passes.size(); ++p) {
    hazards.list(p);
    startImages(graph, graph.passes[p]);
    graph.passes[p].waits.clear();
  }
  // What stands in a frame depends on what stood in the one before. It settles after a frame or two; should it ever
  // not, a frame that trusts only its own barriers is right as well.
  Placement placement(graph);
  constexpr int kTries = 8;
  // Dependencies reach two frames back, so that three have to be alike.
  for (int i = 0, alike = 0; i < kTries; ++i) {
    alike = placement.frame() ? alike + 1 : 0;
    if (alike == 2) return;
  }
  placement.forget();
  placement.frame();
}

}  // namespace weir::graph
