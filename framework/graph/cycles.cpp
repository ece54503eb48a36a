// Cycles without @previous. One wrong reference can close many cycles at once, so what is reported is not each cycle
// but each reference that has to go: when a single one breaks all cycles of a tangle, that is the one finding.
#include <weir/graph/checked.h>

#include <fmt/format.h>

#include <algorithm>

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
    std::set<std::pair<uint32_t, uint32_t>> seen;
    leaving_.resize(checked.nodes.size());
    for (uint32_t n = 0; n < checked.nodes.size(); ++n)
      for (const Link& link : checked.nodes[n].links) {
        if (checked.nodes[n].type && link.input == kNone) continue;  // an input that does not exist reads nothing
        const Source& source = link.resolved;
        if (source.node == kNone || source.previous || source.provided != kNone ||
            !seen.insert({source.node, n}).second)
          continue;
        leaving_[source.node].push_back(edges_.size());
        edges_.push_back({source.node, n, &link});
      }
  }

  void report() {
    for (uint32_t n = 0; n < checked_.nodes.size(); ++n) {
      for (std::vector<size_t> cycle = path(n, n); !cycle.empty(); cycle = path(n, n)) {
        const size_t culprit = findCulprit(cycle);
        std::vector<size_t> rest = path(edges_[culprit].to, edges_[culprit].from);
        say(culprit, rest);
        edges_[culprit].removed = true;
      }
    }
  }

 private:
  /// The shortest path of at least one edge, as edge indices; empty when there is none.
  std::vector<size_t> path(uint32_t from, uint32_t to) const {
    constexpr size_t kUnseen = ~size_t{0};
    std::vector<size_t> reachedBy(checked_.nodes.size(), kUnseen);
    std::vector<uint32_t> queue{from};
    for (size_t next = 0; next < queue.size(); ++next)
      for (size_t e : leaving_[queue[next]]) {
        const Edge& edge = edges_[e];
        if (edge.removed || reachedBy[edge.to] != kUnseen) continue;
        reachedBy[edge.to] = e;
        if (edge.to == to) return walkBack(reachedBy, from, to);
        queue.push_back(edge.to);
      }
    return {};
  }

  std::vector<size_t> walkBack(const std::vector<size_t>& reachedBy, uint32_t from, uint32_t to) const {
    std::vector<size_t> steps;
    uint32_t at = to;
    do {
      steps.push_back(reachedBy[at]);
      at = edges_[steps.back()].from;
    } while (at != from);
    std::reverse(steps.begin(), steps.end());
    return steps;
  }

  /// Whoever is written first in the file and reads something later is the likely slip.
  bool readsBackwards(const Edge& edge) const {
    return checked_.nodes[edge.to].entry->line <= checked_.nodes[edge.from].entry->line;
  }

  size_t findCulprit(const std::vector<size_t>& cycle) {
    size_t best = cycle.front();
    int bestScore = -1;
    for (size_t e : cycle) {  // an edge that breaks every cycle of the tangle lies on this one
      edges_[e].removed = true;
      const bool breaksAll = std::none_of(cycle.begin(), cycle.end(), [&](size_t other) {
        return !path(edges_[other].from, edges_[other].from).empty();
      });
      edges_[e].removed = false;
      const int score = (breaksAll ? 2 : 0) + (readsBackwards(edges_[e]) ? 1 : 0);
      if (score > bestScore) best = e, bestScore = score;
    }
    return best;
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
};

}  // namespace

void findCycles(const Checked& checked, Findings& findings) {
  CycleFinder(checked, findings).report();
}

}  // namespace weir::graph
