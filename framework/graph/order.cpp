// Which passes run, in which order, and why the others do not.
#include <weir/graph/checked.h>
#include <weir/graph/names.h>

#include <fmt/format.h>

#include <functional>
#include <queue>

namespace weir::graph {
namespace {

/// Everything that an output depends on, in this frame or by way of earlier ones.
std::vector<bool> findLive(const Checked& checked) {
  std::vector<bool> live(checked.nodes.size(), false);
  std::vector<uint32_t> open;
  const auto reach = [&](const Source& source) {
    if (source.node == kNone || source.provided != kNone || live[source.node]) return;
    live[source.node] = true;
    open.push_back(source.node);
  };
  for (const OutputLink& output : checked.outputs) reach(output.resolved);
  while (!open.empty()) {
    const uint32_t n = open.back();
    open.pop_back();
    for (const Link& link : checked.nodes[n].links) reach(link.resolved);
  }
  return live;
}

std::string disabledReason(const Checked& checked, const Node& node) {
  std::string text;
  for (const PortDescription& port : node.type->outputs) {
    if (port.passesThrough.empty()) continue;
    for (const Link& link : node.links)
      if (link.input != kNone && node.type->inputs[link.input].name == port.passesThrough)
        text += fmt::format("; {} stands for its '{}'", checked.text(link.written), port.name);
  }
  return "it is disabled" + text;
}

/// By pass: who reads it, in this frame or the last, running or not; disabled passes read what they would if enabled.
std::vector<std::vector<uint32_t>> findReaders(const Checked& checked) {
  std::vector<std::vector<uint32_t>> readers(checked.nodes.size());
  for (uint32_t n = 0; n < checked.nodes.size(); ++n)
    for (const Link& link : checked.nodes[n].links) {
      const Source& source = checked.nodes[n].enabled() ? link.resolved : link.written;
      if (source.node == kNone || source.provided != kNone) continue;
      std::vector<uint32_t>& list = readers[source.node];
      if (list.empty() || list.back() != n) list.push_back(n);
    }
  return readers;
}

std::string unreadReason(const Checked& checked, uint32_t unread, const std::vector<uint32_t>& readBy) {
  std::vector<std::string> readers;
  for (const Source& provided : checked.provided)
    if (provided.node == unread) return "the host provides what is read of it";
  for (const uint32_t reader : readBy) readers.push_back(checked.nodes[reader].name());
  if (readers.empty()) return "nothing reads it";
  return fmt::format("no output depends on it: only {} read{} it, and {} skipped too", listed(readers),
                     readers.size() == 1 ? "s" : "", readers.size() == 1 ? "is" : "are");
}

}  // namespace

Order orderPasses(const Checked& checked) {
  const std::vector<bool> live = findLive(checked);
  std::vector<uint32_t> waitsFor(checked.nodes.size(), 0);
  std::vector<std::vector<uint32_t>> readers(checked.nodes.size());
  for (uint32_t n = 0; n < checked.nodes.size(); ++n)
    for (const Link& link : checked.nodes[n].links)
      if (live[n] && link.resolved.node != kNone && !link.resolved.previous && link.resolved.provided == kNone) {
        readers[link.resolved.node].push_back(n);
        ++waitsFor[n];
      }

  Order order;
  // Nodes are sorted by name, so the smallest index that is ready is the first name that is.
  std::priority_queue<uint32_t, std::vector<uint32_t>, std::greater<>> ready;
  for (uint32_t n = 0; n < checked.nodes.size(); ++n)
    if (live[n] && waitsFor[n] == 0) ready.push(n);
  while (!ready.empty()) {
    const uint32_t n = ready.top();
    ready.pop();
    order.nodes.push_back(n);
    for (uint32_t reader : readers[n])
      if (--waitsFor[reader] == 0) ready.push(reader);
  }

  if (order.nodes.size() == checked.nodes.size()) return order;
  const std::vector<std::vector<uint32_t>> readBy = findReaders(checked);
  for (uint32_t n = 0; n < checked.nodes.size(); ++n) {
    const Node& node = checked.nodes[n];
    if (!node.enabled())
      order.skipped.push_back({node.name(), disabledReason(checked, node)});
    else if (!live[n])
      order.skipped.push_back({node.name(), unreadReason(checked, n, readBy[n])});
  }
  return order;
}

}  // namespace weir::graph
