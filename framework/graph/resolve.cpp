// Takes disabled passes out of the graph: whoever reads one reads what it passes through, any number of passes up.
#include <weir/graph/checked.h>

#include <fmt/format.h>

#include <algorithm>

namespace weir::graph {
namespace {

class Resolver {
 public:
  Resolver(Checked& checked, Findings& findings) : checked_(checked), findings_(findings) {}

  void resolve() {
    ways_.resize(checked_.nodes.size());
    for (uint32_t n = 0; n < ways_.size(); ++n)
      if (const Node& node = checked_.nodes[n]; !node.enabled() && node.type)
        ways_[n].resize(node.type->outputs.size());
    for (Node& node : checked_.nodes) {
      if (!node.enabled()) continue;  // what a disabled pass reads is read by nobody
      for (Link& link : node.links) {
        if (staysOpen(node, link)) continue;
        link.resolved = follow(link.written, link.entry->line,
                               [&] { return fmt::format("passes.{}.inputs.{}", node.name(), link.entry->port); });
      }
    }
    for (OutputLink& output : checked_.outputs)
      output.resolved = follow(output.written, output.entry->line, [&] { return "outputs." + output.entry->name; });
  }

 private:
  /// Where a way goes from an output of a disabled pass to a last frame's value.
  struct Meeting {
    uint32_t node = kNone;
    Source next;
  };

  /// Where an output of a disabled pass leads. Kept for each, so that many readers of a long chain walk it once.
  struct Way {
    enum class Kind : uint8_t { Unknown, OnPath, Ends, Stops, Loops };
    Kind kind = Kind::Unknown;
    Source end;             ///< Ends: of an enabled pass; Stops: where it can't go on; Loops: the first on the loop
    Meeting first, second;  ///< of the ways a frame back, at most two
  };

  struct Step {
    Source at, next;
  };

  /// An optional input, and what it reads is there only while a pass is enabled that isn't.
  bool staysOpen(const Node& node, const Link& link) const {
    if (link.input == kNone || !link.written.known() || enabled(link.written) || isProvided(link.written)) return false;
    const PortDescription& output = checked_.nodes[link.written.node].type->outputs[link.written.output];
    return output.absentWhenDisabled && !node.type->inputs[link.input].required;
  }
  bool enabled(const Source& source) const { return checked_.nodes[source.node].enabled(); }
  /// Whether the host brings the very thing: then it does not matter what stands for it otherwise.
  bool isProvided(const Source& source) const {
    return std::any_of(checked_.provided.begin(), checked_.provided.end(), [&](const Source& p) {
      return p.node == source.node && p.output == source.output && p.previous == source.previous;
    });
  }
  Way& wayOf(const Source& source) { return ways_[source.node][source.output]; }

  /// `line` and `path` are the reader's. A source without a node comes back when something was wrong, now or before.
  template <typename PathOf>
  Source follow(const Source& written, int line, const PathOf& path) {
    if (written.node == kNone || enabled(written) || isProvided(written)) return written;
    if (!written.known()) return {};
    const Way& way = walk(written);
    const Meeting& meeting = written.previous ? way.first : way.second;
    if (meeting.node != kNone) {
      findings_.add(
          line, path(),
          fmt::format("'{}' leads through the disabled pass '{}' to '{}', which makes it two frames old; "
                      "expected at most one @previous on the way",
                      checked_.text(written), checked_.nodes[meeting.node].name(), checked_.text(meeting.next)));
      return {};
    }
    if (way.kind == Way::Kind::Stops) step(way.end, true);
    if (way.kind == Way::Kind::Loops) reportLoop(way.end);
    if (way.kind != Way::Kind::Ends) return {};
    Source end = way.end;
    end.previous = written.previous || way.first.node != kNone;
    return end;
  }

  const Way& walk(const Source& from) {
    std::vector<Step> path;
    Way way;
    for (Source at = from; way.kind == Way::Kind::Unknown;) {
      if (enabled(at) || isProvided({at.node, at.output, false})) {
        way = {Way::Kind::Ends, at, {}, {}};
      } else if (!at.known()) {
        way = {Way::Kind::Stops, at, {}, {}};
      } else if (wayOf(at).kind == Way::Kind::OnPath) {
        way = closeLoop(path, at);
      } else if (wayOf(at).kind != Way::Kind::Unknown) {
        way = wayOf(at);
      } else {
        wayOf(at).kind = Way::Kind::OnPath;
        path.push_back({at, step(at, false)});
        if (path.back().next.node == kNone) way = {Way::Kind::Stops, at, {}, {}};
        at = path.back().next;
      }
    }
    for (; !path.empty(); path.pop_back()) {
      goBack(way, path.back());
      wayOf(path.back().at) = way;
    }
    return wayOf(from);
  }

  /// The way from one step earlier.
  static void goBack(Way& way, const Step& step) {
    if (step.next.node == kNone || !step.next.previous) return;
    way.second = way.first;
    way.first = {step.at.node, step.next};
  }

  /// Takes the steps of a loop off the path; the way of its first one comes back.
  Way closeLoop(std::vector<Step>& path, const Source& entry) {
    const auto isEntry = [&](const Step& s) { return s.at.node == entry.node && s.at.output == entry.output; };
    const auto begin = std::find_if(path.begin(), path.end(), isEntry);
    const auto turns = std::count_if(begin, path.end(), [](const Step& s) { return s.next.previous; });
    Way way{Way::Kind::Loops, entry, {}, {}};
    for (const bool store : {false, true})  // the first round finds what comes after the loop's end
      for (auto s = path.end(); s != begin;) {
        goBack(way, *--s);
        if (turns < 2) way.second = {};  // once round the loop, and no further
        way.end = s->at;
        if (store) wayOf(s->at) = way;
      }
    path.erase(begin, path.end());
    return way;
  }

  /// From an output of a disabled pass to what stands for it; nothing when nothing can, and with `say` the reason why.
  Source step(const Source& source, bool say) {
    if (!source.known()) return {};
    const Node& node = checked_.nodes[source.node];
    const PortDescription& output = node.type->outputs[source.output];
    if (output.passesThrough.empty())
      return !say ? Source{}
                  : refuse(source, fmt::format("its output '{}' is read and passes nothing through", output.name));
    const auto input = std::find_if(node.type->inputs.begin(), node.type->inputs.end(),
                                    [&](const PortDescription& port) { return port.name == output.passesThrough; });
    if (!compatible(output.type, input->type))
      return !say ? Source{}
                  : refuse(source, fmt::format("its output '{}' is {}, its input '{}', which would stand for it, is {}",
                                               output.name, describe(output.type), input->name, describe(input->type)));
    const Link* link = node.linkOf(static_cast<uint32_t>(input - node.type->inputs.begin()));
    if (link) return link->written;
    if (input->required || !say) return {};  // that a required one is open has been said
    return refuse(source, fmt::format("its input '{}', which would stand for its output '{}', is not connected",
                                      input->name, output.name));
  }

  Source refuse(const Source& source, const std::string& why) {
    const PassEntry& entry = *checked_.nodes[source.node].entry;
    if (refused_.insert({source.node, source.output}).second)
      findings_.add(entry.enabledLine, fmt::format("passes.{}.enabled", entry.name),
                    fmt::format("pass '{}' ({}) can't be disabled: {}", entry.name, entry.type, why), "",
                    entry.enabledOrigin);
    return {};
  }

  /// Once for all of its readers; `entry` is the first of its outputs that a reader comes to.
  void reportLoop(const Source& entry) {
    std::string text;
    for (Source at = entry; inLoops_.insert({at.node, at.output}).second; at = step(at, false))
      text += checked_.nodes[at.node].name() + " → ";
    if (text.empty()) return;
    const PassEntry& first = *checked_.nodes[entry.node].entry;
    findings_.add(first.line, "passes." + first.name,
                  fmt::format("disabled passes stand for each other in a cycle: {}{}", text, first.name));
  }

  Checked& checked_;
  Findings& findings_;
  std::vector<std::vector<Way>> ways_;  ///< by node and output; empty for enabled passes
  std::set<std::pair<uint32_t, uint32_t>> refused_, inLoops_;
};

}  // namespace

void resolve(Checked& checked, Findings& findings) {
  Resolver(checked, findings).resolve();
}

}  // namespace weir::graph
