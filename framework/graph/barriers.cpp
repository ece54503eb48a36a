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
// A memory barrier is global: it holds for everything that its stages did, not for one resource, and barriers chain. So
// a dependency from pass A to pass B is an interval of time, a barrier a point in it, and the fewest barriers are the
// fewest points that every interval contains one of: going through the frame, one is placed where an interval ends that
// has none yet. What of it others there see to is then taken away again, so that no bit is left that nobody needs.
#include <weir/graph/checked.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <span>
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
    for (uint32_t r = 0; r < graph.resources.size(); ++r)
      if (graph.resources[r].shares) sharing_.push_back(r);
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

  /// Who had a byte last waited for all who had it before, so that for each byte one use has to be over.
  void takeOver(CompiledPass& p, uint32_t resource) {
    const Resource& r = graph_.resources[resource];
    const auto passes = static_cast<uint32_t>(graph_.passes.size());
    before_.clear();
    for (const uint32_t other : sharing_) {
      const Resource& o = graph_.resources[other];
      if (other != resource && shareMemory(r, o))
        before_.emplace_back(o.lastUse < r.firstUse ? o.lastUse + passes : o.lastUse, other);
    }
    std::sort(before_.begin(), before_.end(), std::greater<>());
    open_.assign(1, {r.offset, r.offset + r.memoryBytes});
    for (const auto& [lastUse, other] : before_)
      if (takeFromOpen(graph_.resources[other])) usesOf(p, resource, other, lastUse >= passes ? 0 : 1);
    if (!open_.empty()) usesOf(p, resource, resource, 1);
  }

  /// Whether some of the bytes that nobody was found for yet were this one's; then they are found.
  bool takeFromOpen(const Resource& r) {
    const uint64_t begin = r.offset, end = r.offset + r.memoryBytes;
    rest_.clear();
    bool taken = false;
    for (const Bytes& bytes : open_) {
      if (bytes.end <= begin || end <= bytes.begin) {
        rest_.push_back(bytes);
        continue;
      }
      taken = true;
      if (bytes.begin < begin) rest_.push_back({bytes.begin, begin});
      if (end < bytes.end) rest_.push_back({end, bytes.end});
    }
    open_.swap(rest_);
    return taken;
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
  std::vector<uint32_t> sharing_;
  struct Bytes {
    uint64_t begin, end;
  };
  std::vector<Bytes> open_, rest_;
  std::vector<std::pair<uint32_t, uint32_t>> before_;  ///< last use, resource
};

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
    for (Dependency& d : p.dependencies) d.covered = isOfStart(d) || isMet(d, p, reach_);
    Command& command = waits_[index];
    command = {};
    for (const Dependency& d : p.dependencies)
      if (!d.covered) add(command, d, p);
    if (command != Command{}) reduce(command, p);
    reach_ = reach_.after(command, now_, stages_);
  }

  /// Whether all that a pass depends on is over when its barriers stand where `before` holds.
  bool isRight(uint32_t index, const Reach& before) const {
    const CompiledPass& p = graph_.passes[index];
    const Reach after = before.after(waits_[index], now_, stages_);
    for (const Dependency& d : p.dependencies) {
      if (!isOfStart(d) && !isMet(d, p, after)) return false;
      for (const ImageStart& s : p.starts)
        if (!isMet(d, s, before)) return false;
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
      reach_ = reach_.after(waits_[p], now_, stages_);
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
      for (ImageStart& start : p.starts)
        for (const Stages stage : kStages)
          tryLess(index, start, [&](ImageStart& s) { s.from &= static_cast<Stages>(~stage); });
      for (const size_t from : stages_)
        for (const size_t to : stages_)
          for (const uint8_t effect : kLosses)
            tryLess(index, waits_[index][from][to], [&](uint8_t& d) { d = static_cast<uint8_t>(d & ~effect); });
      for (Dependency& d : p.dependencies) d.covered = isOfStart(d) || isMet(d, p, reach_);
      reach_ = reach_.after(waits_[index], now_, stages_);
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

  /// An image that takes over memory has a barrier of its own, which orders it after all that had the memory. That is
  /// all it does: what its stages order beyond the image the validation layers don't see, and what others wrote there
  /// they didn't write through this image, so that making it available takes a barrier for all memory.
  void startImages(CompiledPass& p) const {
    p.starts.clear();
    for (const Dependency& d : p.dependencies) {
      if (!isStarted(d)) continue;
      if (p.starts.empty() || p.starts.back().resource != d.resource) p.starts.push_back({d.resource});
      p.starts.back().from |= graph_.passes[d.pass].stages;
    }
    for (ImageStart& start : p.starts)
      for (const Stages stage : kStages) {
        ImageStart less = start;
        less.from &= static_cast<Stages>(~stage);
        if (std::all_of(p.dependencies.begin(), p.dependencies.end(),
                        [&](const Dependency& d) { return isMet(d, less, reach_); }))
          start = less;
      }
  }

  /// What a barrier has to come after.
  Time used(const Dependency& d) const {
    const Time at = time(d.pass, d.framesBack);
    return farthest_ < now_ ? std::max(at, now_ - farthest_) : at;
  }

  /// Whether it is of an image that starts.
  bool isStarted(const Dependency& d) const {
    const Resource& r = graph_.resources[d.resource];
    return d.hazard != Hazard::ReadAfterWrite && r.shares && r.isImage();
  }
  /// Whether the image's own barrier is enough for it.
  bool isOfStart(const Dependency& d) const { return d.hazard == Hazard::WriteAfterRead && isStarted(d); }

  /// Whether the image's barrier, if it is this one's, comes after it: from the stages of the use itself, or by a chain.
  bool isMet(const Dependency& d, const ImageStart& start, const Reach& reach) const {
    if (d.resource != start.resource || !isStarted(d)) return true;
    const Time used = this->used(d);
    for (const size_t stage : stages_) {
      if (!has(graph_.passes[d.pass].stages, stage) || has(start.from, stage)) continue;
      if (std::none_of(stages_.begin(), stages_.end(),
                       [&](size_t via) { return has(start.from, via) && reach.of[stage][via].order > used; }))
        return false;
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
  void reduce(Command& command, const CompiledPass& p) const {
    for (const uint8_t effect : kLosses)
      for (const size_t from : stages_)
        for (const size_t to : stages_) {
          const uint8_t whole = command[from][to];
          command[from][to] = static_cast<uint8_t>(whole & ~effect);
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
          return alike(j) == alike(w) && std::tie(j.writes, j.toReads, j.toWrites) ==
                                             std::tie(w.writes, w.toReads, w.toWrites);
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
  Time farthest_ = 0;  ///< to look back
  std::vector<size_t> stages_;  ///< that the graph has any work in
  std::vector<Command> waits_;  ///< by pass
  Reach reach_;
};

}  // namespace

void planBarriers(CompiledGraph& graph) {
  Hazards hazards(graph);
  for (uint32_t p = 0; p < graph.passes.size(); ++p) {
    hazards.list(p);
    graph.passes[p].waits.clear();
    graph.passes[p].starts.clear();
  }
  Placement(graph).plan();
}

}  // namespace weir::graph
