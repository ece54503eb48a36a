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
      for (uint32_t o = 0; o < checked_.nodes[n].perPixel.size(); ++o) count(n, o);
    for (const Node& node : checked_.nodes)
      for (const Link& link : node.links) matchLink(node, link);
  }

 private:
  enum class State : uint8_t { Unknown, Asked, Known };

  /// A disabled pass is checked against what it names, so that enabling it holds no surprise.
  static const Source& sourceOf(const Node& node, const Link& link) {
    return node.enabled() ? link.resolved : link.written;
  }

  /// An output whose count is being asked for, and whether it was reached by way of last frame's value or the host's.
  struct Step {
    uint32_t node, output;
    bool previous;
  };

  /// A circle within one frame is findCycles()'s to report, once; left for here are those through last frame's values.
  bool isReportedAsCycle(const Step& again) const {
    bool everPrevious = again.previous;
    for (size_t i = path_.size(); i-- > 0 && (path_[i].node != again.node || path_[i].output != again.output);)
      everPrevious |= path_[i].previous;
    return checked_.nodes[again.node].enabled() && !everPrevious;
  }

  /// Finds the elements a pixel of an output, and of all those whose count it has; 0 when it can't be known.
  void count(uint32_t n, uint32_t o) {
    uint32_t found = 0;
    path_.clear();
    for (Step at{n, o, false};;) {
      Node& node = checked_.nodes[at.node];
      State& state = state_[at.node][at.output];
      const PortDescription& port = node.type->outputs[at.output];
      if (state == State::Known) {
        found = node.perPixel[at.output];
        break;
      }
      if (state == State::Asked) {
        if (!isReportedAsCycle(at))
          findings_.add(
              node.entry->line, "passes." + node.name(),
              fmt::format("the count of elements of output '{}' depends on itself, by way of its inputs", port.name));
        break;
      }
      state = State::Asked;
      path_.push_back(at);
      if (port.type.perPixelFromParam.empty() && !port.type.perPixelFromInput.empty()) {
        const Source source = countedSource(node, port);
        if (!source.known()) break;
        at = {source.node, source.output, source.previous || source.provided != kNone};
        continue;
      }
      found = port.type.perPixelFromParam.empty() ? port.type.perPixel : countFromParam(node, port);
      break;
    }
    for (const Step& step : path_) {
      state_[step.node][step.output] = State::Known;
      checked_.nodes[step.node].perPixel[step.output] = found;
    }
  }

  /// What is connected to the input whose count an output has.
  static Source countedSource(const Node& node, const PortDescription& port) {
    for (const Link& link : node.links)
      if (link.input != kNone && node.type->inputs[link.input].name == port.type.perPixelFromInput)
        return sourceOf(node, link);
    return {};
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
  std::vector<Step> path_;  ///< of the counts that are Asked, in order
};

}  // namespace

void matchPorts(Checked& checked, Findings& findings) {
  Matcher(checked, findings).match();
}

}  // namespace weir::graph
