// Names to things: types, ports and the passes that references mean.
#include <weir/graph/checked.h>
#include <weir/graph/names.h>

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <unordered_map>
#include <utility>

namespace weir::graph {
namespace {

template <typename Items>
uint32_t indexOf(const Items& items, const std::string& name) {
  for (size_t i = 0; i < items.size(); ++i)
    if (items[i].name == name) return static_cast<uint32_t>(i);
  return kNone;
}

class Binder {
 public:
  Binder(const PassCatalog& catalog, Findings& findings) : catalog_(catalog), findings_(findings) {}

  Checked bind(const Description& description) {
    if (description.passes.size() > kMostPasses)
      findings_.add(description.passes[kMostPasses].line, "passes",
                    fmt::format("there are {} passes; expected at most {}", description.passes.size(), kMostPasses));
    std::vector<Node> nodes;
    nodes.reserve(description.passes.size());
    for (const PassEntry& entry : description.passes) {
      Node& node = nodes.emplace_back();
      node.entry = &entry;
      node.type = findType(entry);
      if (node.type) bindParams(node, findings_);
    }
    sortByName(std::move(nodes));
    for (Node& node : checked_.nodes) bindInputs(node);
    for (const OutputEntry& entry : description.outputs) {
      OutputLink link{&entry, {}, {}};
      if (entry.source) link.written = find(*entry.source, entry.line, [&] { return "outputs." + entry.name; });
      checked_.outputs.push_back(link);
    }
    return std::move(checked_);
  }

 private:
  /// The file's order means nothing, so nothing may come of it.
  void sortByName(std::vector<Node> nodes) {
    std::vector<std::pair<std::string_view, Node*>> order;
    order.reserve(nodes.size());
    for (Node& node : nodes) order.emplace_back(node.name(), &node);
    std::sort(order.begin(), order.end());
    checked_.nodes.reserve(nodes.size());
    byName_.reserve(nodes.size());
    for (const auto& [name, node] : order) {
      byName_.emplace(name, static_cast<uint32_t>(checked_.nodes.size()));
      checked_.nodes.push_back(std::move(*node));
    }
  }

  const PassDescription* findType(const PassEntry& entry) {
    if (entry.type.empty()) return nullptr;  // said by the parser
    const auto [known, isNew] = types_.try_emplace(entry.type, nullptr);
    if (isNew) known->second = catalog_.find(entry.type);
    if (known->second) return known->second;
    if (typeNames_.empty()) typeNames_ = catalog_.types();
    const std::string nearest = nearest_.find(entry.type, typeNames_);
    const std::string problem = catalog_.problem ? catalog_.problem(entry.type) : "";
    std::string message = fmt::format("unknown type '{}'", entry.type);
    if (!problem.empty()) message += ": " + problem;
    if (nearest.empty()) message += "; expected one of: " + listed(typeNames_);
    findings_.add(entry.typeLine, "passes." + entry.name + ".type", message, nearest);
    return nullptr;
  }

  void bindInputs(Node& node) {
    std::vector<Link*> unknown;
    std::vector<bool> connected(node.type ? node.type->inputs.size() : 0, false);
    node.links.reserve(node.entry->inputs.size());
    for (const InputEntry& entry : node.entry->inputs) {
      Link& link = node.links.emplace_back();
      link.entry = &entry;
      if (entry.source) link.written = find(*entry.source, entry.line, [&] { return inputPath(node, entry.port); });
      if (!node.type) continue;
      link.input = indexOf(node.type->inputs, entry.port);
      if (link.input == kNone)
        unknown.push_back(&link);
      else
        connected[link.input] = true;
    }
    if (!node.type) return;
    for (Link* link : unknown) bindUnknown(node, *link, connected);
    if (node.entry->inputsBroken) return;
    for (uint32_t i = 0; i < node.type->inputs.size(); ++i) {
      const PortDescription& port = node.type->inputs[i];
      if (port.required && !connected[i])
        findings_.add(node.entry->line, inputPath(node, port.name),
                      fmt::format("required input '{}' of {} is not connected; expected a reference to {}", port.name,
                                  node.type->type, describe(port.type)));
    }
  }

  /// A misspelt input is taken for the open one that it resembles, so that one slip stays one finding.
  void bindUnknown(const Node& node, Link& link, std::vector<bool>& connected) {
    std::vector<std::string> open;
    for (uint32_t i = 0; i < node.type->inputs.size(); ++i)
      if (!connected[i]) open.push_back(node.type->inputs[i].name);
    const std::vector<std::string> all = namesOf(node.type->inputs);
    std::string nearest = nearest_.find(link.entry->port, open);
    if (!nearest.empty()) {
      link.input = indexOf(node.type->inputs, nearest);
      connected[link.input] = true;
    } else {
      nearest = nearest_.find(link.entry->port, all);
    }
    findings_.add(link.entry->nameLine, inputPath(node, link.entry->port),
                  fmt::format("unknown input '{}'; {} has: {}", link.entry->port, node.type->type, listed(all)),
                  nearest);
  }

  /// `path` yields the reader's place, for messages.
  template <typename PathOf>
  Source find(const Reference& reference, int line, const PathOf& path) {
    Source source;
    source.previous = reference.previous;
    const auto found = byName_.find(reference.pass);
    if (found == byName_.end()) {
      if (passNames_.empty())
        for (const Node& n : checked_.nodes) passNames_.push_back(n.name());
      findings_.add(line, path(),
                    fmt::format("there is no pass '{}'; the graph has: {}", reference.pass, listed(passNames_)),
                    nearest_.find(reference.pass, passNames_));
      return source;
    }
    source.node = found->second;
    const PassDescription* type = checked_.nodes[source.node].type;
    if (!type) return source;
    source.output = indexOf(type->outputs, reference.port);
    if (source.output == kNone) {
      const std::vector<std::string> names = namesOf(type->outputs);
      findings_.add(line, path(),
                    fmt::format("pass '{}' ({}) has no output '{}'; it has: {}", reference.pass, type->type,
                                reference.port, listed(names)),
                    nearest_.find(reference.port, names));
    }
    return source;
  }

  static std::string inputPath(const Node& node, const std::string& port) {
    return fmt::format("passes.{}.inputs.{}", node.name(), port);
  }

  const PassCatalog& catalog_;
  Findings& findings_;
  Checked checked_;
  std::unordered_map<std::string_view, uint32_t> byName_;               ///< nodes, by their entries' texts
  std::unordered_map<std::string_view, const PassDescription*> types_;  ///< that were asked for, by the entries' texts
  std::vector<std::string> typeNames_, passNames_;                      ///< once a message needs them
  NearestNames nearest_;
};

}  // namespace

const Link* Node::linkOf(uint32_t input) const {
  const auto found = std::find_if(links.begin(), links.end(), [&](const Link& link) { return link.input == input; });
  return found == links.end() ? nullptr : &*found;
}

std::string Checked::text(const Source& source) const {
  if (source.node == kNone) return "nothing";
  const Node& node = nodes[source.node];
  return fmt::format("{}.{}{}", node.name(), source.known() ? node.type->outputs[source.output].name : "?",
                     source.previous ? "@previous" : "");
}

Checked bind(const Description& description, const PassCatalog& catalog, Findings& findings) {
  return Binder(catalog, findings).bind(description);
}

}  // namespace weir::graph
