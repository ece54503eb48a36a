// What each pass depends on, in a frame that follows another frame of the same graph.
//
// A resource has one producer, which writes it before anybody reads it in the frame. So a copy goes through these
// phases:
//
//   without history      | write ─► reads                       | write (next frame) …
//   with, two copies     | write ─► reads ─► reads as previous  | write (the frame after the next) …
//
// and where memory is shared, the last reads of whoever had it stand before the write too.
#include <weir/graph/checked.h>

#include <algorithm>
#include <iterator>
#include <vector>

namespace weir::graph {
namespace {

/// Who had each byte of a block last.
class Owners {
 public:
  struct Part {
    uint64_t begin = 0, end = 0;
    uint32_t resource = kNone, frame = 0;
  };

  /// Makes `next` the owner of its bytes; returns who had some of them, each once.
  const std::vector<Part>& take(const Part& next) {
    taken_.clear();
    rest_.clear();
    // Parts are sorted and lie apart: those that overlap are neighbours.
    const auto first =
        std::partition_point(parts_.begin(), parts_.end(), [&](const Part& p) { return p.end <= next.begin; });
    auto last = first;
    for (; last != parts_.end() && last->begin < next.end; ++last) {
      const bool known =
          std::any_of(taken_.begin(), taken_.end(), [&](const Part& t) { return t.resource == last->resource; });
      if (!known) taken_.push_back(*last);
      if (last->begin < next.begin) rest_.push_back({last->begin, next.begin, last->resource, last->frame});
    }
    rest_.push_back(next);
    if (first != last && std::prev(last)->end > next.end) {
      const Part& behind = *std::prev(last);
      rest_.push_back({next.end, behind.end, behind.resource, behind.frame});
    }
    parts_.insert(parts_.erase(first, last), rest_.begin(), rest_.end());
    return taken_;
  }

 private:
  std::vector<Part> parts_, taken_, rest_;
};

class Lister {
 public:
  explicit Lister(CompiledGraph& graph)
      : graph_(graph), readers_(graph.resources.size()), later_(readers_.size()), owners_(graph.blocks.size()) {
    for (uint32_t p = 0; p < graph.passes.size(); ++p)
      for (const Binding& input : graph.passes[p].inputs)
        if (input.resource != kNone) addOnce((input.previous ? later_ : readers_)[input.resource], p);
  }

  void list() {
    // Once through the frame before, to know who has the memory when a frame begins.
    for (const CompiledPass& pass : graph_.passes) {
      for (const Binding& output : pass.outputs) takeBytes(output.resource);
      for (const uint32_t scratch : pass.scratch) takeBytes(scratch);
    }
    frame_ = 1;
    for (CompiledPass& pass : graph_.passes) list(pass);
  }

 private:
  static void addOnce(std::vector<uint32_t>& list, uint32_t pass) {
    if (list.empty() || list.back() != pass) list.push_back(pass);
  }

  const std::vector<Owners::Part>& takeBytes(uint32_t resource) {
    static const std::vector<Owners::Part> kNobody;
    const Resource& r = graph_.resources[resource];
    return r.shares ? owners_[r.block].take({r.offset, r.offset + r.memoryBytes, resource, frame_}) : kNobody;
  }

  void list(CompiledPass& p) {
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

  void beforeWriting(CompiledPass& p, uint32_t resource) {
    const Resource& r = graph_.resources[resource];
    if (r.external) return;  // the host comes before and after
    // Who had a byte last waited for all who had it before, so that for each byte one use has to be over.
    for (const Owners::Part& had : takeBytes(resource)) usesOf(p, resource, had.resource, frame_ - had.frame);
    if (r.shares) return;
    usesOf(p, resource, resource, r.history ? 2 : 1);
    for (const uint32_t reader : later_[resource])
      p.dependencies.push_back({Hazard::WriteAfterRead, resource, resource, reader, 1});
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
  std::vector<Owners> owners_;                          ///< by block
  uint32_t frame_ = 0;
};

}  // namespace

void listDependencies(CompiledGraph& graph) {
  Lister(graph).list();
}

}  // namespace weir::graph
