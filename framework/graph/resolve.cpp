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
    for (Node& node : checked_.nodes) {
      if (!node.enabled()) continue;  // what a disabled pass reads is read by nobody
      for (Link& link : node.links)
        link.resolved =
            follow(link.written, link.entry->line, fmt::format("passes.{}.inputs.{}", node.name(), link.entry->port));
    }
    for (OutputLink& output : checked_.outputs)
      output.resolved = follow(output.written, output.entry->line, "outputs." + output.entry->name);
  }

 private:
  /// `line` and `path` are the reader's. A source without a node comes back when something was wrong, now or before.
  Source follow(Source source, int line, const std::string& path) {
    const Source written = source;
    std::vector<uint32_t> passed;
    while (source.node != kNone && !checked_.nodes[source.node].enabled()) {
      if (std::find(passed.begin(), passed.end(), source.node) != passed.end()) return reportLoop(passed, source.node);
      passed.push_back(source.node);
      const Source next = stepThrough(source);
      if (next.node == kNone) return {};
      if (source.previous && next.previous) {
        findings_.add(line, path,
                      fmt::format("'{}' leads through the disabled pass '{}' to '{}', which makes it two frames old; "
                                  "expected at most one @previous on the way",
                                  checked_.text(written), checked_.nodes[source.node].name(), checked_.text(next)));
        return {};
      }
      const bool previous = source.previous || next.previous;
      source = next;
      source.previous = previous;
    }
    return source;
  }

  /// From an output of a disabled pass to what stands for it.
  Source stepThrough(const Source& source) {
    const Node& node = checked_.nodes[source.node];
    if (!source.known()) return {};
    const PortDescription& output = node.type->outputs[source.output];
    if (output.passesThrough.empty())
      return refuse(source, fmt::format("its output '{}' is read and passes nothing through", output.name));
    const auto input = std::find_if(node.type->inputs.begin(), node.type->inputs.end(),
                                    [&](const PortDescription& port) { return port.name == output.passesThrough; });
    if (!compatible(output.type, input->type))
      return refuse(source, fmt::format("its output '{}' is {}, its input '{}', which would stand for it, is {}",
                                        output.name, describe(output.type), input->name, describe(input->type)));
    const Link* link = node.linkOf(static_cast<uint32_t>(input - node.type->inputs.begin()));
    if (link) return link->written;
    if (input->required) return {};  // that it is open has been said
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

  Source reportLoop(const std::vector<uint32_t>& passed, uint32_t again) {
    const std::vector<uint32_t> loop(std::find(passed.begin(), passed.end(), again), passed.end());
    if (!loops_.insert({loop.begin(), loop.end()}).second) return {};
    std::string text;
    for (uint32_t node : loop) text += checked_.nodes[node].name() + " → ";
    const PassEntry& entry = *checked_.nodes[again].entry;
    findings_.add(entry.line, "passes." + entry.name,
                  fmt::format("disabled passes stand for each other in a cycle: {}{}", text, entry.name));
    return {};
  }

  Checked& checked_;
  Findings& findings_;
  std::set<std::pair<uint32_t, uint32_t>> refused_;
  std::set<std::set<uint32_t>> loops_;
};

}  // namespace

void resolve(Checked& checked, Findings& findings) {
  Resolver(checked, findings).resolve();
}

}  // namespace weir::graph
