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
    say("\nOrder of the passes in a frame. in: what it reads; out: who reads what it writes; own: scratch memory; "
        "wait: what has\n"
        "to be over before it runs; barrier: what is recorded for that, stages before -> stages after.\n");
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
    say("{:>3}. {} ({}), {}\n", index + 1, p.name, p.type, stagesText(p.stages));
    for (const Binding& input : p.inputs) {
      if (input.resource == kNone)
        say("       in   {} <- nothing (optional)\n", input.port);
      else
        say("       in   {} <- {}\n", input.port, name(input.resource, input.previous));
    }
    for (const uint32_t scratch : p.scratch) say("       own  {}\n", graph_.resources[scratch].name);
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
    barriers(p);
  }

  static std::string stagesText(Stages stages) {
    std::vector<std::string> names;
    if ((stages & kComputeStage) != 0) names.emplace_back("compute");
    if ((stages & kRayStage) != 0) names.emplace_back("rays");
    if ((stages & kRasterStage) != 0) names.emplace_back("raster");
    return names.empty() ? "nothing" : fmt::format("{}", fmt::join(names, "+"));
  }

  /// What the pass waits for and was not waited for before; how much more there was; and the barriers that do it.
  void barriers(const CompiledPass& p) {
    size_t covered = 0;
    for (const Dependency& d : p.dependencies) {
      const bool start =
          std::any_of(p.starts.begin(), p.starts.end(), [&](const ImageStart& s) { return s.resource == d.resource; });
      if (d.covered && !(start && d.hazard != Hazard::ReadAfterWrite))
        ++covered;
      else
        say("       wait {}\n", dependencyText(d));
    }
    if (covered > 0) say("       wait for {} more: earlier barriers see to it\n", covered);
    for (const Wait& w : p.waits)
      say("       barrier {}{} -> {}{}{}\n", stagesText(w.from), w.writes ? " writes" : "", stagesText(w.to),
          w.toReads ? " reads" : "", w.toWrites ? " writes" : "");
    for (const ImageStart& s : p.starts)
      say("       barrier {} -> {}: {} starts undefined\n", stagesText(s.from), stagesText(p.stages),
          graph_.resources[s.resource].name);
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

  std::string dependencyText(const Dependency& d) const {
    static constexpr const char* kWhen[] = {"", " in the last frame", " two frames ago"};
    const std::string& who = graph_.passes[d.pass].name;
    const std::string& what = graph_.resources[d.memoryOf].name;
    const char* when = kWhen[d.framesBack];
    if (d.hazard == Hazard::ReadAfterWrite)
      return fmt::format("until {} can be read, which {} wrote{}", what, who, when);
    const char* did = d.hazard == Hazard::WriteAfterRead ? "reading" : "writing";
    if (d.memoryOf == d.resource) return fmt::format("until {} is done {} {}{}", who, did, what, when);
    return fmt::format("until {} is done {} {}{}, whose memory {} takes over", who, did, what, when,
                       graph_.resources[d.resource].name);
  }

  static std::string extentText(const Resource& r) {
    if (r.width == 0) return fmt::format("{}", r.elements);
    if (r.perPixel == 1) return fmt::format("{}x{}", r.width, r.height);
    return fmt::format("{}x{}x{}", r.width, r.height, r.perPixel);
  }

  std::string placeText(const Resource& r) const {
    if (r.external) return "the host's";
    if (r.history) return "two copies of its own: history";
    if (r.block == kNone) return "its own";
    return fmt::format("{}{}{}{}", graph_.blocks.size() > 1 ? fmt::format("block {} ", r.block + 1) : "at ",
                       bytesText(r.offset), r.shares ? ", shared" : "",
                       r.graphOutput ? "; output" : (r.kept ? "; kept" : ""));
  }

  void resources() {
    say("\nResources: # marks the passes that each is alive in\n  {:<26} {:<36} {:>12} {:>10}  ", "name", "type",
        "extent", "bytes");
    for (size_t p = 0; p < graph_.passes.size(); ++p) say("{}", (p + 1) % 10);
    say("  memory\n");
    for (const Resource& r : graph_.resources) {
      std::string life(graph_.passes.size(), '.');
      for (size_t p = r.firstUse; p <= r.lastUse && p < life.size(); ++p) life[p] = '#';
      if (r.history) std::fill(life.begin(), life.end(), '#');
      say("  {:<26} {:<36} {:>12} {:>10}  {}  {}\n", r.name, typeText(r.type), extentText(r), bytesText(r.bytes), life,
          placeText(r));
    }
    // Alignment can cost a little more than sharing saves.
    const uint64_t shared = graph_.sharedBytes(), separate = std::max(graph_.separateBytes(), shared);
    if (graph_.blocks.empty()) {
      say("  {} in memory of their own, {} in two copies for history\n", bytesText(separate),
          bytesText(graph_.historyBytes()));
      return;
    }
    say("  {} shared by what would take {} apart: {} saved, {:.0f} %. Most alive at once: {}\n", bytesText(shared),
        bytesText(separate), bytesText(separate - shared),
        separate > 0 ? 100.0 * static_cast<double>(separate - shared) / static_cast<double>(separate) : 0.0,
        bytesText(graph_.mostAlive()));
    say("  {} in two copies for history\n", bytesText(graph_.historyBytes()));
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
