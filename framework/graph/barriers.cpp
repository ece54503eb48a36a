// The barriers that stand before each pass, in a frame that follows another frame of the same graph.
//
// A memory barrier is global: it holds for everything that its stages did, not for one resource. So a dependency from
// pass A to pass B is an interval of time, a barrier a point in it, and the fewest barriers are the fewest points that
// every interval contains one of: going through the frame, one is placed where an interval ends that has none yet.
//
// Two things that Vulkan has are left alone, as the validation layers don't see them: chains of barriers by way of
// other stages, and what an image's own barrier orders beyond that image.
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

/// Times count passes since the first frame; a barrier at time t stands before the pass of that time.
using Time = int64_t;
constexpr Time kNever = std::numeric_limits<Time>::min();

template <typename T>
using ByStages = std::array<std::array<T, kStages.size()>, kStages.size()>;  ///< from, to

/// All that barriers before one pass do, one command: what holds from stage to stage. Any of it orders.
enum Effect : uint8_t { kOrders = 1, kToReads = 2, kToWrites = 4 };
using Command = ByStages<uint8_t>;
/// What is tried to be taken away, in this order.
constexpr std::array<uint8_t, 3> kLosses = {kOrders | kToReads | kToWrites, kToReads, kToWrites};

/// When barriers between two stages stood for the last time.
struct Last {
  Time order = kNever, reads = kNever, writes = kNever;
};

class Placement {
 public:
  explicit Placement(CompiledGraph& graph)
      : graph_(graph), passes_(static_cast<Time>(graph.passes.size())), commands_(graph.passes.size()) {
    for (size_t stage = 0; stage < kStages.size(); ++stage)
      if (std::any_of(graph.passes.begin(), graph.passes.end(),
                      [&](const CompiledPass& p) { return has(p.stages, stage); }))
        stages_.push_back(stage);
  }

  void plan() {
    // What stands in a frame depends on what stood in the one before. Mostly that settles after a frame or two;
    // dependencies reach two frames back, but no further than a frame has to be looked for a barrier.
    constexpr int kTries = 6;
    bool settled = false;
    for (int i = 0; i < kTries && !settled; ++i) settled = frame();
    if (!settled) {  // where one and a half barriers a frame would do, say
      last_ = {};
      frame();  // trusts only its own barriers, so that all frames can be like it
      trim();
    }
    for (uint32_t p = 0; p < graph_.passes.size(); ++p) {
      graph_.passes[p].waits = waitsOf(commands_[p]);
      startImages(graph_.passes[p]);
    }
  }

 private:
  Time time(uint32_t pass, uint32_t framesBack) const { return (frame_ - framesBack) * passes_ + pass; }
  static bool has(Stages mask, size_t stage) { return (mask & kStages[stage]) != 0; }

  /// The barriers of one frame, given those of the frame before it. True when they are the same as that one's.
  bool frame() {
    bool same = true;
    for (uint32_t p = 0; p < graph_.passes.size(); ++p) {
      const Command before = commands_[p];
      place(p);
      same = same && before == commands_[p];
    }
    ++frame_;
    return same;
  }

  void place(uint32_t index) {
    CompiledPass& p = graph_.passes[index];
    now_ = time(index, 0);
    commands_[index] = {};
    for (Dependency& d : p.dependencies) {
      d.covered = isOfStart(d) || isMet(d, p);
      if (!d.covered) add(commands_[index], d, p);
    }
    stand(commands_[index]);
  }

  void stand(const Command& command) {
    for (const size_t from : stages_)
      for (const size_t to : stages_) {
        const uint8_t does = command[from][to];
        Last& last = last_[from][to];
        if (does != 0) last.order = now_;
        if ((does & kToReads) != 0) last.reads = now_;
        if ((does & kToWrites) != 0) last.writes = now_;
      }
  }

  void add(Command& command, const Dependency& d, const CompiledPass& p) const {
    const uint8_t does = kOrders | (d.hazard == Hazard::ReadAfterWrite    ? kToReads
                                    : d.hazard == Hazard::WriteAfterWrite ? kToWrites
                                                                          : 0);
    for (const size_t from : stages_)
      for (const size_t to : stages_)
        if (has(graph_.passes[d.pass].stages, from) && has(p.stages, to) && !isMet(d, last_[from][to]))
          command[from][to] |= does;
  }

  bool isMet(const Dependency& d, const Last& last) const {
    // Each pass's barriers are the same in every frame: a frame is long enough to look back.
    const Time used = std::max(time(d.pass, d.framesBack), now_ - passes_);
    if (d.hazard == Hazard::WriteAfterRead) return last.order > used;
    return (d.hazard == Hazard::ReadAfterWrite ? last.reads : last.writes) > used;
  }

  bool isMet(const Dependency& d, const CompiledPass& p) const {
    for (const size_t from : stages_)
      for (const size_t to : stages_)
        if (has(graph_.passes[d.pass].stages, from) && has(p.stages, to) && !isMet(d, last_[from][to])) return false;
    return true;
  }

  /// Whether frames with these barriers are right.
  bool isRight() {
    last_ = {};
    for (frame_ = 0; frame_ < 2; ++frame_)  // the second one finds the first behind it
      for (uint32_t index = 0; index < graph_.passes.size(); ++index) {
        now_ = time(index, 0);
        stand(commands_[index]);
        for (const Dependency& d : graph_.passes[index].dependencies)
          if (frame_ == 1 && !isOfStart(d) && !isMet(d, graph_.passes[index])) return false;
      }
    return true;
  }

  /// Takes away what is spare when all frames are alike.
  void trim() {
    for (Command& command : commands_)
      for (const size_t from : stages_)
        for (const size_t to : stages_)
          for (const uint8_t effect : kLosses) {
            const uint8_t whole = command[from][to];
            command[from][to] = static_cast<uint8_t>(whole & ~effect);
            if (command[from][to] != whole && !isRight()) command[from][to] = whole;
          }
    isRight();
    for (uint32_t index = 0; index < graph_.passes.size(); ++index) {
      now_ = time(index, 0);
      for (Dependency& d : graph_.passes[index].dependencies)
        d.covered = isOfStart(d) || isMet(d, graph_.passes[index]);
      stand(commands_[index]);
    }
  }

  /// Whether it is of an image that takes over memory.
  bool isStarted(const Dependency& d) const {
    const Resource& r = graph_.resources[d.resource];
    return d.hazard != Hazard::ReadAfterWrite && r.shares && r.isImage();
  }
  /// Whether the image's own barrier is enough for it.
  bool isOfStart(const Dependency& d) const { return d.hazard == Hazard::WriteAfterRead && isStarted(d); }

  /// An image that takes over memory has a barrier of its own, which orders it after all that had the memory. What they
  /// wrote they didn't write through this image, so that making it available takes a barrier for all memory.
  void startImages(CompiledPass& p) const {
    p.starts.clear();
    for (const Dependency& d : p.dependencies) {
      if (!isStarted(d)) continue;
      if (p.starts.empty() || p.starts.back().resource != d.resource) p.starts.push_back({d.resource});
      p.starts.back().from |= graph_.passes[d.pass].stages;
    }
  }

  /// One barrier for each set of stages that waits in the same way.
  std::vector<Wait> waitsOf(const Command& command) const {
    std::vector<Wait> waits;
    for (const size_t from : stages_)
      for (const size_t to : stages_) {
        const uint8_t does = command[from][to];
        const bool toReads = (does & kToReads) != 0, toWrites = (does & kToWrites) != 0;
        if (does != 0) waits.push_back({kStages[from], kStages[to], toReads || toWrites, toReads, toWrites});
      }
    const auto join = [&](auto alike, Stages Wait::*mask) {
      std::vector<Wait> joined;
      for (const Wait& w : waits) {
        const auto found = std::find_if(joined.begin(), joined.end(), [&](const Wait& j) {
          return alike(j) == alike(w) && std::tie(j.toReads, j.toWrites) == std::tie(w.toReads, w.toWrites);
        });
        if (found == joined.end())
          joined.push_back(w);
        else
          (*found).*mask |= w.*mask;
      }
      waits = std::move(joined);
    };
    join([](const Wait& w) { return w.to; }, &Wait::from);
    join([](const Wait& w) { return w.from; }, &Wait::to);
    return waits;
  }

  CompiledGraph& graph_;
  Time passes_, frame_ = 0, now_ = 0;
  std::vector<size_t> stages_;     ///< that the graph has any work in
  std::vector<Command> commands_;  ///< by pass
  ByStages<Last> last_{};
};

}  // namespace

void planBarriers(CompiledGraph& graph) {
  listDependencies(graph);
  Placement(graph).plan();
}

}  // namespace weir::graph
