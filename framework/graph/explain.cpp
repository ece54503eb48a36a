// A compiled graph in words, for somebody who has never seen this code.
#include <weir/graph/compile.h>

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

namespace weir::graph {
namespace {

std::string bytesText(uint64_t bytes) {
  if (bytes < 10'000) return fmt::format("{} B", bytes);
  if (bytes < 10'000'000) return fmt::format("{:.1f} kB", static_cast<double>(bytes) / 1e3);
  return fmt::format("{:.1f} MB", static_cast<double>(bytes) / 1e6);
}

class Explainer {
 public:
  explicit Explainer(const CompiledGraph& graph) : graph_(graph) {}

  std::string explain() {
    say("Graph '{}' at {}x{}{}\n", graph_.name, graph_.width, graph_.height,
        graph_.file.empty() ? "" : " (" + graph_.file + ")");
    say("\nOrder of the passes in a frame\n");
    for (uint32_t p = 0; p < graph_.passes.size(); ++p) pass(p);
    resources();
    outputs();
    skipped();
    return std::move(text_);
  }

 private:
  template <typename... T>
  void say(fmt::format_string<T...> format, T&&... args) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<T>(args)...);
  }

  std::string name(uint32_t resource, bool previous) const {
    return graph_.resources[resource].name + (previous ? "@previous" : "");
  }

  void pass(uint32_t index) {
    const CompiledPass& p = graph_.passes[index];
    say("{:>3}. {} ({})\n", index + 1, p.name, p.type);
    for (const Binding& input : p.inputs) {
      if (input.resource == kNone)
        say("       in   {} <- nothing (optional)\n", input.port);
      else
        say("       in   {} <- {}\n", input.port, name(input.resource, input.previous));
    }
    for (const Binding& output : p.outputs) say("       out  {} -> {}\n", output.port, readers(output.resource));
    if (p.description && !p.description->wants.empty()) {
      say("       takes");
      for (const NeedDescription& want : p.description->wants)
        say(" {}{}", needName(want.need), want.previous ? "@previous" : "");
      say("\n");
    }
    if (!p.params.empty()) {
      say("       with");
      const char* separator = " ";
      for (const auto& [param, value] : p.params)
        say("{}{} = {}", std::exchange(separator, ", "), param, weir::toText(value));
      say("\n");
    }
    for (const Barrier& b : p.barriers) say("       wait {}\n", barrierText(b));
  }

  std::string readers(uint32_t resource) const {
    std::string text;
    const auto add = [&](const std::string& reader) { text += (text.empty() ? "" : ", ") + reader; };
    for (const CompiledPass& p : graph_.passes)
      for (const Binding& input : p.inputs)
        if (input.resource == resource)
          add(fmt::format("{}.{}{}", p.name, input.port, input.previous ? " next frame" : ""));
    for (const GraphOutput& output : graph_.outputs)
      if (output.resource == resource)
        add(fmt::format("output '{}'{}", output.name, output.previous ? " next frame" : ""));
    return text.empty() ? "nobody" : text;
  }

  std::string barrierText(const Barrier& b) const {
    const std::string what = name(b.resource, b.previous);
    const bool reads = b.after == Access::Read;
    if (b.fromPass != kNone)
      return fmt::format("until what {} wrote to {} can be read", graph_.passes[b.fromPass].name, what);
    if (reads) return fmt::format("until what an earlier frame (or the clear) wrote to {} can be read", what);
    return fmt::format("until an earlier frame has stopped {} the memory of {}",
                       b.before == Access::Read ? "reading" : "writing", what);
  }

  void resources() {
    say("\nResources\n  {:<26} {:<44} {:>12} {:>10} {:>7}  {}\n", "name", "type", "extent", "bytes", "copies",
        "alive in passes");
    uint64_t transient = 0, history = 0;
    for (const Resource& r : graph_.resources) {
      const std::string extent = r.width == 0      ? fmt::format("{}", r.elements)
                                 : r.perPixel == 1 ? fmt::format("{}x{}", r.width, r.height)
                                                   : fmt::format("{}x{}x{}", r.width, r.height, r.perPixel);
      const std::string life = r.history       ? "always: history"
                               : r.graphOutput ? fmt::format("{} to the end: output", r.firstUse + 1)
                                               : fmt::format("{} to {}", r.firstUse + 1, r.lastUse + 1);
      say("  {:<26} {:<44} {:>12} {:>10} {:>7}  {}\n", r.name, typeText(r.type), extent, bytesText(r.bytes),
          r.history ? 2 : 1, life);
      (r.history ? history : transient) += r.bytes * (r.history ? 2 : 1);
    }
    say("  in all {} in one copy, {} in two for history\n", bytesText(transient), bytesText(history));
  }

  static std::string typeText(const PortType& type) {
    if (type.kind == PortKind::Image) return describe(type);
    return fmt::format("{} v{} ({} bytes)", type.layout.name, type.layout.version, type.layout.stride);
  }

  void outputs() {
    say("\nOutputs\n");
    for (const GraphOutput& output : graph_.outputs)
      say("  {} <- {}\n", output.name, name(output.resource, output.previous));
  }

  void skipped() {
    if (graph_.skipped.empty()) return;
    say("\nSkipped passes\n");
    for (const Skipped& s : graph_.skipped) say("  {}: {}\n", s.pass, s.reason);
  }

  const CompiledGraph& graph_;
  std::string text_;
};

}  // namespace

std::string explain(const CompiledGraph& graph) {
  return Explainer(graph).explain();
}

}  // namespace weir::graph
