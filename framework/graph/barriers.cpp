// The barriers that stand before each pass, in a frame that follows another frame of the same graph.
//
// A memory barrier is global: it holds for everything that its stages did, not for one resource, and barriers chain. So
// a dependency from pass A to pass B is an interval of time, a barrier a point in it, and the fewest barriers are the
// fewest points that every interval contains one of: going through the frame, one is placed where an interval ends that
// has none yet. What of it others there see to is then taken away again, so that no bit is left that nobody needs.
#include <weir/graph/checked.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <span>
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

/// All that barriers before one pass do, one command: what holds from stage to stage.
enum Effect : uint8_t { kOrders = 1, kMakesAvailable = 2, kToReads = 4, kToWrites = 8 };
using Command = ByStages<uint8_t>;
/// What is tried to be taken away, in this order.
constexpr std::array<uint8_t, 4> kLosses = {kOrders | kMakesAvailable | kToReads | kToWrites, kToReads, kToWrites,
                                            kMakesAvailable};

/// What the barriers so far have come to: the work of one stage before this time is ordered before the coming work of
/// another, its writes available to that one's barriers, visible to its reads, to its writes.
struct Reach {
  struct Times {
    Time order = kNever, available = kNever, reads = kNever, writes = kNever;
  };
  ByStages<Times> of{};

  Reach after(const Command& command, Time now, std::span<const size_t> stages) const {
    Reach next = *this;
    for (const size_t via : stages)
      for (const size_t to : stages) {
        const uint8_t does = command[via][to];
        if (does == 0) continue;
        for (const size_t from : stages) {  // from == via, or a chain
          Times& t = next.of[from][to];
          const Time available = from == via && (does & kMakesAvailable) != 0 ? now : of[from][via].available;
          t.order = std::max(t.order, from == via ? now : of[from][via].order);
          t.available = std::max(t.available, available);
          if ((does & kToReads) != 0) t.reads = std::max(t.reads, available);
          if ((does & kToWrites) != 0) t.writes = std::max(t.writes, available);
        }
      }
    return next;
  }
};

class Placement {
 public:
  explicit Placement(CompiledGraph& graph)
      : graph_(graph), passes_(static_cast<Time>(graph.passes.size())), waits_(graph.passes.size()) {
    for (size_t stage = 0; stage < kStages.size(); ++stage)
      if (std::any_of(graph.passes.begin(), graph.passes.end(),
                      [&](const CompiledPass& p) { return has(p.stages, stage); }))
        stages_.push_back(stage);
  }

  void plan() {
    // What stands in a frame depends on what stood in the one before. It settles after a frame or two. Dependencies
    // reach two frames back, so that three have to be alike.
    constexpr int kTries = 8;
    int alike = 0;
    for (int i = 0; i < kTries && alike < 2; ++i) alike = frame() ? alike + 1 : 0;
    if (alike < 2) {  // a frame that trusts only its own barriers is right as well, and all frames are then like it
      reach_ = {};
      frame();
    }
    trim();
  }

 private:
  Time time(uint32_t pass, uint32_t framesBack) const { return (frame_ - framesBack) * passes_ + pass; }
  static bool has(Stages mask, size_t stage) { return (mask & kStages[stage]) != 0; }

  /// The barriers of one frame, given those of the frames before it. True when they are the same as the frame before's.
  bool frame() {
    // Looking back further than a frame would find the barriers that are just being decided on anew.
    farthest_ = passes_;
    bool same = true;
    for (uint32_t p = 0; p < graph_.passes.size(); ++p) {
      const Command waits = waits_[p];
      const std::vector<ImageStart> starts = std::move(graph_.passes[p].starts);
      place(p);
      same = same && waits == waits_[p] && starts == graph_.passes[p].starts;
    }
    ++frame_;
    return same;
  }

  void place(uint32_t index) {
    CompiledPass& p = graph_.passes[index];
    now_ = time(index, 0);
    startImages(p);
    const Command starts = startsOf(p);
    for (Dependency& d : p.dependencies) d.covered = isStart(d) || isMet(d, p, reach_);
    Command command = starts;
    for (const Dependency& d : p.dependencies)
      if (!d.covered) add(command, d, p);
    if (command != starts) reduce(command, starts, p);
    for (const size_t from : stages_)
      for (const size_t to : stages_)
        waits_[index][from][to] = command[from][to] == starts[from][to] ? uint8_t{0} : command[from][to];
    reach_ = reach_.after(command, now_, stages_);
  }

  /// What the barriers of starting images order is not their images alone.
  Command startsOf(const CompiledPass& p) const {
    Command starts{};
    for (const ImageStart& s : p.starts)
      for (const size_t from : stages_)
        for (const size_t to : stages_)
          if (has(s.from, from) && has(p.stages, to)) starts[from][to] = kOrders;
    return starts;
  }

  Command commandOf(uint32_t index) const {
    Command command = startsOf(graph_.passes[index]);
    for (const size_t from : stages_)
      for (const size_t to : stages_) command[from][to] |= waits_[index][from][to];
    return command;
  }

  /// Whether all that a pass depends on is over when its barriers stand where `before` holds.
  bool isRight(uint32_t index, const Reach& before) const {
    const CompiledPass& p = graph_.passes[index];
    const Reach after = before.after(commandOf(index), now_, stages_);
    for (const Dependency& d : p.dependencies) {
      if (!isStart(d) && !isMet(d, p, after)) return false;
      for (const ImageStart& s : p.starts)
        if (s.resource == d.resource && isStart(d) && !isMet(d, s, before)) return false;
    }
    return true;
  }

  /// Goes through frames with the barriers as they are, up to before a pass of the fourth: what came before the first
  /// makes no difference any more. Whether that last one is right as far as it goes.
  bool follow(uint32_t end) {
    constexpr Time kFourth = 3;
    reach_ = {};
    for (Time step = 0; step < kFourth * passes_ + end; ++step) {
      const auto p = static_cast<uint32_t>(step % passes_);
      frame_ = step / passes_;
      now_ = step;
      if (frame_ == kFourth && !isRight(p, reach_)) return false;
      reach_ = reach_.after(commandOf(p), now_, stages_);
    }
    frame_ = kFourth;
    now_ = time(end, 0);
    return true;
  }

  /// Takes away what turns out to be spare when all frames are alike.
  void trim() {
    farthest_ = std::numeric_limits<Time>::max();
    follow(0);
    for (uint32_t index = 0; index < graph_.passes.size(); ++index) {
      CompiledPass& p = graph_.passes[index];
      now_ = time(index, 0);
      for (ImageStart& start : p.starts) {
        tryLess(index, start, [](ImageStart& s) { s.writes = false; });
        for (const Stages stage : kStages)
          tryLess(index, start, [&](ImageStart& s) { s.from &= static_cast<Stages>(~stage); });
      }
      for (const size_t from : stages_)
        for (const size_t to : stages_)
          for (const uint8_t effect : kLosses)
            tryLess(index, waits_[index][from][to], [&](uint8_t& d) { d = static_cast<uint8_t>(d & ~effect); });
      for (Dependency& d : p.dependencies) d.covered = isStart(d) || isMet(d, p, reach_);
      reach_ = reach_.after(commandOf(index), now_, stages_);
      p.waits.clear();
      for (const size_t from : stages_)
        for (const size_t to : stages_)
          if (waits_[index][from][to] != 0) p.waits.push_back(waitOf(from, to, waits_[index][from][to]));
      merge(p);
    }
  }

  template <typename T, typename Change>
  void tryLess(uint32_t index, T& what, const Change& change) {
    const T whole = what;
    change(what);
    if (what == whole) return;
    // Nearly always it is this very pass that needs it.
    if (isRight(index, reach_)) {
      const bool right = follow(static_cast<uint32_t>(graph_.passes.size()));
      if (!right) what = whole;
      follow(index);
      if (right) return;
    }
    what = whole;
  }

  /// An image that takes over memory has a barrier of its own, for all that it depends on.
  void startImages(CompiledPass& p) const {
    p.starts.clear();
    for (const Dependency& d : p.dependencies) {
      if (!isStart(d)) continue;
      if (p.starts.empty() || p.starts.back().resource != d.resource) p.starts.push_back({d.resource});
      p.starts.back().from |= graph_.passes[d.pass].stages;
      p.starts.back().writes |= d.hazard == Hazard::WriteAfterWrite;
    }
    for (ImageStart& start : p.starts) {
      ImageStart less = start;
      const auto tryIt = [&] {
        const bool enough = std::all_of(p.dependencies.begin(), p.dependencies.end(), [&](const Dependency& d) {
          return d.resource != less.resource || !isStart(d) || isMet(d, less, reach_);
        });
        (enough ? start : less) = enough ? less : start;
      };
      less.writes = false;
      tryIt();
      for (const Stages stage : kStages) {
        less.from &= static_cast<Stages>(~stage);
        tryIt();
      }
    }
  }

  /// What a barrier has to come after.
  Time used(const Dependency& d) const {
    const Time at = time(d.pass, d.framesBack);
    return farthest_ < now_ ? std::max(at, now_ - farthest_) : at;
  }

  bool isStart(const Dependency& d) const {
    const Resource& r = graph_.resources[d.resource];
    return d.hazard != Hazard::ReadAfterWrite && r.shares && r.isImage();
  }

  /// Whether the image's barrier comes after it: from the stages of the use itself, or by a chain.
  bool isMet(const Dependency& d, const ImageStart& start, const Reach& reach) const {
    const Time used = this->used(d);
    const bool wrote = d.hazard == Hazard::WriteAfterWrite;
    for (const size_t stage : stages_) {
      if (!has(graph_.passes[d.pass].stages, stage)) continue;
      bool met = has(start.from, stage) && (start.writes || !wrote);
      for (const size_t via : stages_) {
        const Reach::Times& t = reach.of[stage][via];
        met |= has(start.from, via) && (wrote ? t.available : t.order) > used;
      }
      if (!met) return false;
    }
    return true;
  }

  bool isMet(const Dependency& d, const Reach::Times& t) const {
    const Time used = this->used(d);
    if (d.hazard == Hazard::WriteAfterRead) return t.order > used;
    return (d.hazard == Hazard::ReadAfterWrite ? t.reads : t.writes) > used;
  }

  bool isMet(const Dependency& d, const CompiledPass& p, const Reach& reach) const {
    for (const size_t from : stages_)
      for (const size_t to : stages_)
        if (has(graph_.passes[d.pass].stages, from) && has(p.stages, to) && !isMet(d, reach.of[from][to])) return false;
    return true;
  }

  void add(Command& command, const Dependency& d, const CompiledPass& p) const {
    const Reach reach = reach_.after(command, now_, stages_);
    uint8_t does = kOrders;
    if (d.hazard == Hazard::ReadAfterWrite) does |= kMakesAvailable | kToReads;
    if (d.hazard == Hazard::WriteAfterWrite) does |= kMakesAvailable | kToWrites;
    for (const size_t from : stages_)
      for (const size_t to : stages_)
        if (has(graph_.passes[d.pass].stages, from) && has(p.stages, to) && !isMet(d, reach.of[from][to]))
          command[from][to] |= does;
  }

  /// Takes away what the rest does without: first whole pairs of stages, then single effects.
  void reduce(Command& command, const Command& starts, const CompiledPass& p) const {
    for (const uint8_t effect : kLosses)
      for (const size_t from : stages_)
        for (const size_t to : stages_) {
          const uint8_t whole = command[from][to];
          command[from][to] = static_cast<uint8_t>((whole & ~effect) | starts[from][to]);
          if (command[from][to] == whole) continue;
          const Reach reach = reach_.after(command, now_, stages_);
          if (!std::all_of(p.dependencies.begin(), p.dependencies.end(),
                           [&](const Dependency& d) { return d.covered || isMet(d, p, reach); }))
            command[from][to] = whole;
        }
  }

  static Wait waitOf(size_t from, size_t to, uint8_t does) {
    return {kStages[from], kStages[to], (does & kMakesAvailable) != 0, (does & kToReads) != 0, (does & kToWrites) != 0};
  }

  /// One barrier for each set of stages that waits in the same way.
  static void merge(CompiledPass& p) {
    const auto join = [&](auto alike, Stages Wait::*mask) {
      std::vector<Wait> joined;
      for (const Wait& w : p.waits) {
        const auto found = std::find_if(joined.begin(), joined.end(), [&](const Wait& j) {
          return alike(j) == alike(w) &&
                 std::tie(j.writes, j.toReads, j.toWrites) == std::tie(w.writes, w.toReads, w.toWrites);
        });
        if (found == joined.end())
          joined.push_back(w);
        else
          (*found).*mask |= w.*mask;
      }
      p.waits = std::move(joined);
    };
    join([](const Wait& w) { return w.to; }, &Wait::from);
    join([](const Wait& w) { return w.from; }, &Wait::to);
  }

  CompiledGraph& graph_;
  Time passes_, frame_ = 0, now_ = 0;
  Time farthest_ = 0;           ///< to look back
  std::vector<size_t> stages_;  ///< that the graph has any work in
  std::vector<Command> waits_;  ///< by pass
  Reach reach_;
};

}  // namespace

void planBarriers(CompiledGraph& graph) {
  listDependencies(graph);
  for (CompiledPass& pass : graph.passes) {
    pass.waits.clear();
    pass.starts.clear();
  }
  Placement(graph).plan();
}

}  // namespace weir::graph
