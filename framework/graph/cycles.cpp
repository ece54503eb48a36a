// Cycles without @previous. One wrong reference can close many cycles at once, so what is reported is not each cycle
// but each reference that has to go: when a single one breaks all cycles of a tangle, that is the one finding.
//
// Tangles are found in one pass over the graph, and most graphs have none. The search for culprits inside of them takes
// longer the more there are; it has a budget, as in a file made for it it would take hours.
#include <weir/graph/checked.h>

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace weir::graph {
namespace {

/// `to` reads this frame's value of `from`.
struct Edge {
  uint32_t from, to;
  const Link* link;
  bool removed = false;
};

class CycleFinder {
 public:
  CycleFinder(const Checked& checked, Findings& findings) : checked_(checked), findings_(findings) {
    const size_t nodes = checked.nodes.size();
    std::vector<uint32_t> seenBy(nodes, kNone);
    leaving_.resize(nodes);
    for (uint32_t n = 0; n < nodes; ++n)
      for (const Link& link : checked.nodes[n].links) {
        if (checked.nodes[n].type && link.input == kNone) continue;  // an input that does not exist reads nothing
        const Source& source = link.resolved;
        if (source.node == kNone || source.previous || source.provided != kNone || seenBy[source.node] == n) continue;
        seenBy[source.node] = n;
        leaving_[source.node].push_back(edges_.size());
        edges_.push_back({source.node, n, &link});
      }
  }

  void report() {
    if (isFree()) return;
    findTangles();
    for (uint32_t n = 0; n < checked_.nodes.size(); ++n) {
      bool split = false;
      for (std::vector<size_t> cycle = path(n, n); !cycle.empty(); cycle = path(n, n)) {
        const size_t culprit = findCulprit(cycle);
        std::vector<size_t> rest = path(edges_[culprit].to, edges_[culprit].from);
        if (left_ == 0) break;
        say(culprit, rest);
        edges_[culprit].removed = true;
        split = true;
      }
      if (left_ > 0) {
        if (split) splitTangle(tangle_[n]);
        continue;
      }
      findings_.add(checked_.nodes[n].entry->line, "passes." + checked_.nodes[n].name(),
                    "the passes form very many cycles; expected none, and those that are listed to be mended first");
      return;
    }
  }

 private:
  /// Whether there is no cycle: one after another, every pass can go whose sources have gone.
  bool isFree() const {
    std::vector<uint32_t> waitsFor(leaving_.size(), 0), gone;
    for (const Edge& edge : edges_) ++waitsFor[edge.to];
    for (uint32_t n = 0; n < waitsFor.size(); ++n)
      if (waitsFor[n] == 0) gone.push_back(n);
    for (size_t next = 0; next < gone.size(); ++next)
      for (size_t e : leaving_[gone[next]])
        if (--waitsFor[edges_[e].to] == 0) gone.push_back(edges_[e].to);
    return gone.size() == leaving_.size();
  }

  /// Gives each pass its tangle, and each tangle its passes: those that all depend on each other.
  void findTangles() {
    const size_t nodes = checked_.nodes.size();
    reachedBy_.resize(nodes);
    reachedIn_.resize(nodes, 0);
    visit_.resize(nodes);
    tangle_.assign(nodes, 0);
    members_.resize(1);
    members_[0].resize(nodes);
    std::iota(members_[0].begin(), members_[0].end(), 0u);
    splitTangle(0);
  }

  /// With some of its edges gone, a tangle may be several.
  void splitTangle(uint32_t tangle) {
    const std::vector<uint32_t> nodes = std::move(members_[tangle]);
    const uint32_t parts = components(nodes);
    const auto firstNew = static_cast<uint32_t>(members_.size());
    members_[tangle].clear();
    members_.resize(members_.size() + parts - 1);
    for (const uint32_t n : nodes) {
      const uint32_t part = visit_[n].component;
      tangle_[n] = part == 0 ? tangle : firstNew + part - 1;
      members_[tangle_[n]].push_back(n);
    }
  }

  /// Tarjan 1972, without recursion: strongly connected components of a tangle's passes. How many comes back.
  uint32_t components(const std::vector<uint32_t>& nodes) {
    for (const uint32_t n : nodes) visit_[n] = {};
    left_ -= std::min<uint64_t>(left_, nodes.size());
    std::vector<uint32_t> path, open;
    uint32_t order = 0, component = 0;
    for (const uint32_t root : nodes) {
      if (visit_[root].order == 0) path.push_back(root);
      while (!path.empty()) {
        const uint32_t n = path.back();
        Visit& visit = visit_[n];
        if (visit.order == 0) {
          visit.order = visit.low = ++order;
          open.push_back(n);
        }
        uint32_t deeper = kNone;
        for (; visit.edge < leaving_[n].size() && deeper == kNone; ++visit.edge) {
          const Edge& edge = edges_[leaving_[n][visit.edge]];
          left_ -= std::min<uint64_t>(left_, 1);
          if (edge.removed || tangle_[edge.to] != tangle_[n] || visit_[edge.to].component != kNone) continue;
          if (visit_[edge.to].order == 0)
            deeper = edge.to;
          else
            visit.low = std::min(visit.low, visit_[edge.to].order);
        }
        if (deeper != kNone) {
          path.push_back(deeper);
          continue;
        }
        path.pop_back();
        if (!path.empty()) visit_[path.back()].low = std::min(visit_[path.back()].low, visit.low);
        if (visit.low != visit.order) continue;
        for (uint32_t last = kNone; last != n; open.pop_back()) visit_[last = open.back()].component = component;
        ++component;
      }
    }
    return component;
  }

  /// The shortest path of at least one edge, as edge indices; empty when there is none, or no more budget.
  std::vector<size_t> path(uint32_t from, uint32_t to) {
    ++search_;
    std::vector<uint32_t> queue{from};
    for (size_t next = 0; next < queue.size(); ++next)
      for (size_t e : leaving_[queue[next]]) {
        const Edge& edge = edges_[e];
        if (left_ == 0) return {};
        --left_;
        if (edge.removed || tangle_[edge.to] != tangle_[from] || reachedIn_[edge.to] == search_) continue;
        reachedIn_[edge.to] = search_;
        reachedBy_[edge.to] = e;
        if (edge.to == to) return walkBack(from, to);
        queue.push_back(edge.to);
      }
    return {};
  }

  std::vector<size_t> walkBack(uint32_t from, uint32_t to) const {
    std::vector<size_t> steps;
    uint32_t at = to;
    do {
      steps.push_back(reachedBy_[at]);
      at = edges_[steps.back()].from;
    } while (at != from);
    std::reverse(steps.begin(), steps.end());
    return steps;
  }

  /// Whoever is written first in the file and reads something later is the likely slip.
  bool readsBackwards(const Edge& edge) const {
    return checked_.nodes[edge.to].entry->line <= checked_.nodes[edge.from].entry->line;
  }

  /// Whether no pass of a cycle is on any cycle without that edge.
  bool breaksAll(size_t e, const std::vector<size_t>& cycle) {
    edges_[e].removed = true;
    components(members_[tangle_[edges_[e].from]]);
    const bool breaks = std::all_of(cycle.begin(), cycle.end(), [&](size_t other) {
      const uint32_t n = edges_[other].from;
      return std::none_of(leaving_[n].begin(), leaving_[n].end(), [&](size_t leaving) {
        const Edge& edge = edges_[leaving];
        return !edge.removed && tangle_[edge.to] == tangle_[n] && visit_[edge.to].component == visit_[n].component;
      });
    });
    edges_[e].removed = false;
    return breaks;
  }

  /// An edge that breaks every cycle of the tangle lies on this one. Best is one that reads backwards too.
  size_t findCulprit(const std::vector<size_t>& cycle) {
    const auto backwards = [&](size_t e) { return readsBackwards(edges_[e]); };
    for (const bool wanted : {true, false})
      for (const size_t e : cycle)
        if (backwards(e) == wanted && left_ > 0 && breaksAll(e, cycle)) return e;
    const auto first = std::find_if(cycle.begin(), cycle.end(), backwards);
    return first == cycle.end() ? cycle.front() : *first;
  }

  void say(size_t culprit, const std::vector<size_t>& rest) {
    const Edge& edge = edges_[culprit];
    const auto& name = [&](uint32_t n) { return checked_.nodes[n].name(); };
    std::string text = name(edge.from) + " → " + name(edge.to);
    if (edge.from != edge.to)
      for (size_t e : rest) text += " → " + name(edges_[e].to);
    findings_.add(edge.link->entry->line, fmt::format("passes.{}.inputs.{}", name(edge.to), edge.link->entry->port),
                  fmt::format("the passes form a cycle: {}; expected one of them to read the other's last frame, as "
                              "\"{}@previous\"",
                              text, edge.link->entry->text));
  }

  const Checked& checked_;
  Findings& findings_;
  std::vector<Edge> edges_;
  std::vector<std::vector<size_t>> leaving_;  ///< edges by the pass they leave

  /// A pass in the search for components.
  struct Visit {
    uint32_t order = 0, low = 0;  ///< 0: not visited
    uint32_t component = kNone;
    uint32_t edge = 0;  ///< the next of those that leave it
  };
  std::vector<Visit> visit_;
  std::vector<uint32_t> tangle_;  ///< of each pass
  std::vector<std::vector<uint32_t>> members_;

  std::vector<size_t> reachedBy_;    ///< by pass: the edge, in the search that
  std::vector<uint64_t> reachedIn_;  ///< this says
  uint64_t search_ = 0;
  uint64_t left_ = 4'000'000;  ///< edges and passes to look at before giving up
};

}  // namespace

void findCycles(const Checked& checked, Findings& findings) {
  CycleFinder(checked, findings).report();
}

}  // namespace weir::graph
