// Whether what is connected fits: layout or format, scale, and elements a pixel.
#include <weir/graph/checked.h>

#include <fmt/format.h>

namespace weir::graph {
namespace {

class Matcher {
 public:
  Matcher(Checked& checked, Findings& findings) : checked_(checked), findings_(findings) {}

  void match() {
    for (Node& node : checked_.nodes) {
      if (node.type) node.perPixel.assign(node.type->outputs.size(), 0);
      state_.emplace_back(node.perPixel.size(), State::Unknown);
    }
    for (uint32_t n = 0; n < checked_.nodes.size(); ++n)
      for (uint32_t o = 0; o < checked_.nodes[n].perPixel.size(); ++o) count(n, o, false);
    for (const Node& node : checked_.nodes)
      for (const Link& link : node.links) matchLink(node, link);
  }

 private:
  enum class State : uint8_t { Unknown, Asked, Known };

  /// A disabled pass is checked against what it names, so that enabling it holds no surprise.
  static const Source& sourceOf(const Node& node, const Link& link) {
    return node.enabled() ? link.resolved : link.written;
  }

  /// An output whose count is being asked for, and whether it was reached by way of last frame's value.
  struct Step {
    uint32_t node, output;
    bool previous;
  };

  /// A circle within one frame is findCycles()'s to report, once; left for here are those through last frame's values.
  bool isReportedAsCycle(uint32_t n, uint32_t o, bool previous) const {
    bool everPrevious = previous;
    for (size_t i = path_.size(); i-- > 0 && (path_[i].node != n || path_[i].output != o);)
      everPrevious |= path_[i].previous;
    return checked_.nodes[n].enabled() && !everPrevious;
  }

  /// Elements a pixel of an output; 0 when it can't be known.
  uint32_t count(uint32_t n, uint32_t o, bool previous) {
    Node& node = checked_.nodes[n];
    State& state = state_[n][o];
    if (state == State::Known) return node.perPixel[o];
    const PortDescription& port = node.type->outputs[o];
    if (state == State::Asked) {
      if (!isReportedAsCycle(n, o, previous))
        findings_.add(
            node.entry->line, "passes." + node.name(),
            fmt::format("the count of elements of output '{}' depends on itself, by way of its inputs", port.name));
      state = State::Known;
      return 0;
    }
    state = State::Asked;
    path_.push_back({n, o, previous});
    const uint32_t found = findCount(node, port);
    path_.pop_back();
    state = State::Known;
    return node.perPixel[o] = found;
  }

  uint32_t findCount(const Node& node, const PortDescription& port) {
    const PortType& type = port.type;
    if (!type.perPixelFromParam.empty()) return countFromParam(node, port);
    if (type.perPixelFromInput.empty()) return type.perPixel;
    for (const Link& link : node.links) {
      if (link.input == kNone || node.type->inputs[link.input].name != type.perPixelFromInput) continue;
      const Source& source = sourceOf(node, link);
      return source.known() ? count(source.node, source.output, source.previous) : 0;
    }
    return 0;
  }

  uint32_t countFromParam(const Node& node, const PortDescription& port) {
    const std::string& name = port.type.perPixelFromParam;
    const int32_t value = std::get<int32_t>(node.params.at(name));
    if (value >= 1) return static_cast<uint32_t>(value);
    int line = node.entry->line;
    std::string origin;
    for (const ParamEntry& entry : node.entry->params)
      if (entry.name == name) line = entry.line, origin = entry.origin;
    findings_.add(
        line, fmt::format("passes.{}.params.{}", node.name(), name),
        fmt::format("output '{}' has '{}' elements a pixel; expected at least 1, not {}", port.name, name, value), "",
        origin);
    return 0;
  }

  void matchLink(const Node& node, const Link& link) {
    const Source& source = sourceOf(node, link);
    if (!node.type || link.input == kNone || !source.known()) return;
    const PortDescription& input = node.type->inputs[link.input];
    const PortDescription& output = checked_.port(source);
    std::string expected, found;
    if (!compatible(output.type, input.type)) {
      expected = describe(input.type);
      found = describe(output.type);
    } else {
      const uint32_t perPixel = checked_.nodes[source.node].perPixel[source.output];
      if (perPixel == 0 || sameExtent(output.type, perPixel, input.type)) return;
      expected = extent(input.type, input.type.perPixel, input.type.anyPerPixel);
      found = extent(output.type, perPixel, false);
    }
    std::string name = fmt::format("'{}'", checked_.text(source));
    if (source.node != link.written.node)
      name += fmt::format(" (which stands for '{}', disabled)", checked_.text(link.written));
    findings_.add(link.entry->line, fmt::format("passes.{}.inputs.{}", node.name(), link.entry->port),
                  fmt::format("input '{}' expected {}, but {} is {}", input.name, expected, name, found));
  }

  static bool sameExtent(const PortType& output, uint32_t perPixel, const PortType& input) {
    if (output.fixedCount != input.fixedCount) return false;
    if (output.fixedCount != 0) return true;
    if (uint64_t{output.scaleNumerator} * input.scaleDenominator !=
        uint64_t{input.scaleNumerator} * output.scaleDenominator)
      return false;
    return input.anyPerPixel || perPixel == input.perPixel;
  }

  static std::string extent(const PortType& type, uint32_t perPixel, bool any) {
    std::string text = describe(type);
    if (type.fixedCount != 0) return text + fmt::format(" with {} elements", type.fixedCount);
    if (type.kind == PortKind::Buffer)
      text += any ? std::string(" with any number of elements a pixel")
                  : fmt::format(" with {} element{} a pixel", perPixel, perPixel == 1 ? "" : "s");
    if (type.scaleNumerator != type.scaleDenominator)
      return text + fmt::format(" at {}/{} of the frame's size", type.scaleNumerator, type.scaleDenominator);
    return text + " at the frame's size";
  }

  Checked& checked_;
  Findings& findings_;
  std::vector<std::vector<State>> state_;
  std::vector<Step> path_;  // of the counts that are Asked, in order
};

}  // namespace

void matchPorts(Checked& checked, Findings& findings) {
  Matcher(checked, findings).match();
}

}  // namespace weir::graph
