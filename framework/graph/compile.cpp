#include <weir/core/error.h>
#include <weir/core/text.h>
#include <weir/graph/checked.h>

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

namespace weir::graph {
namespace {

constexpr uint32_t kLargestFrame = 65536;

void checkFrameSize(uint32_t width, uint32_t height, Findings& findings) {
  if (width >= 1 && height >= 1 && width <= kLargestFrame && height <= kLargestFrame) return;
  findings.add(0, "", fmt::format("the frame is {}x{}; expected 1 to {} each way", width, height, kLargestFrame), "",
               "--size");
}

/// The port that a name means; one that is not known when there is none.
Source portNamed(const Checked& checked, const std::string& name) {
  const std::optional<Reference> reference = parseReference(name);
  for (uint32_t n = 0; reference && n < checked.nodes.size(); ++n) {
    if (checked.nodes[n].name() != reference->pass || !checked.nodes[n].type) continue;
    const auto& outputs = checked.nodes[n].type->outputs;
    for (uint32_t o = 0; o < outputs.size(); ++o)
      if (outputs[o].name == reference->port) return {n, o, reference->previous};
  }
  return {};
}

/// Each name must be a port of the graph, whether its pass runs or not, and stand there once.
void checkPorts(const Checked& checked, const char* what, const std::vector<std::string>& names, bool previous) {
  for (size_t i = 0; i < names.size(); ++i) {
    const Source source = portNamed(checked, names[i]);
    if (std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(i), names[i]) !=
        names.begin() + static_cast<std::ptrdiff_t>(i))
      throw InputError(fmt::format("{}: '{}' is named twice", what, names[i]));
    if (source.known() && (previous || !source.previous)) continue;
    std::vector<std::string> ports;
    for (const Node& node : checked.nodes)
      if (node.type)
        for (const PortDescription& port : node.type->outputs) ports.push_back(node.name() + "." + port.name);
    const std::string nearest = nearestName(names[i], ports);
    throw InputError(fmt::format("{}: the graph has no port '{}'{}", what, names[i],
                                 nearest.empty() ? "" : fmt::format(" (nearest: '{}')", nearest)));
  }
}

/// What the host provides, as ports.
void findProvided(Checked& checked, const CompileOptions& options) {
  checkPorts(checked, "provided", options.provided, true);
  checkPorts(checked, "external", options.external, false);
  checkPorts(checked, "keep", options.keep, false);
  for (const std::string& name : options.provided) {
    if (std::find(options.external.begin(), options.external.end(), name) != options.external.end())
      throw InputError(fmt::format("'{}' can't be both provided by the host and written for it", name));
    checked.provided.push_back(portNamed(checked, name));
  }
}

/// Marks what leads there: readers of those ports have no producer to wait for.
void markProvided(Checked& checked) {
  const auto mark = [&](Source& resolved, const std::string& reader) {
    for (uint32_t i = 0; i < checked.provided.size(); ++i) {
      const Source& p = checked.provided[i];
      if (resolved.node != p.node || resolved.output != p.output || resolved.previous != p.previous) continue;
      resolved.provided = i;
      return;
    }
    for (const Source& p : checked.provided)
      if (resolved.previous && !p.previous && p.node == resolved.node && p.output == resolved.output)
        throw InputError(
            fmt::format("provided: '{}' comes from the host, and '{}' reads its @previous: provide '{}' too",
                        checked.text(p), reader, checked.text(resolved)));
  };
  for (Node& node : checked.nodes)
    for (Link& link : node.links)
      if (node.enabled()) mark(link.resolved, node.name());
  for (OutputLink& output : checked.outputs) mark(output.resolved, output.entry->name);
}

}  // namespace

const GraphOutput* CompiledGraph::findOutput(const std::string& outputName) const {
  const auto found = std::find_if(outputs.begin(), outputs.end(),
                                  [&](const GraphOutput& output) { return output.name == outputName; });
  return found == outputs.end() ? nullptr : &*found;
}

CompiledGraph compile(const Description& description, const PassCatalog& catalog, const CompileOptions& options,
                      std::vector<Diagnostic>& diagnostics) {
  CompiledGraph graph;
  graph.name = description.name;
  graph.file = description.file;
  graph.width = options.width;
  graph.height = options.height;
  Findings findings(description.file, diagnostics);
  if (description.broken) return graph;
  checkFrameSize(options.width, options.height, findings);
  Checked checked = bind(description, catalog, findings);
  if (!findings.any()) findProvided(checked, options);
  resolve(checked, findings);
  if (!findings.any()) markProvided(checked);
  matchPorts(checked, findings);
  findCycles(checked, findings);
  if (description.outputs.empty() && !findings.any())
    findings.add(0, "outputs", "there is no output; expected at least one");
  if (findings.any()) return graph;
  plan(checked, orderPasses(checked), options, graph, findings);
  if (findings.any()) return graph;
  planMemory(graph, logicalNeeds(graph));
  planBarriers(graph);
  return graph;
}

CompiledGraph compile(const Description& description, const PassCatalog& catalog, uint32_t width, uint32_t height,
                      std::vector<Diagnostic>& diagnostics) {
  CompileOptions options;
  options.width = width;
  options.height = height;
  return compile(description, catalog, options, diagnostics);
}

CompiledGraph compileFile(const std::string& path, const Overrides& overrides, const PassCatalog& catalog,
                          uint32_t width, uint32_t height) {
  CompileOptions options;
  options.width = width;
  options.height = height;
  return compileFile(path, overrides, catalog, options);
}

namespace {

CompiledGraph compileOrThrow(Description description, const Overrides& overrides, const PassCatalog& catalog,
                             const CompileOptions& options, std::vector<Diagnostic> diagnostics) {
  apply(description, overrides, diagnostics);
  CompiledGraph graph = compile(description, catalog, options, diagnostics);
  if (diagnostics.empty()) return graph;
  // In the file's order, which is how somebody will go through them.
  std::stable_sort(diagnostics.begin(), diagnostics.end(), [](const Diagnostic& a, const Diagnostic& b) {
    return std::tie(a.file, a.line) < std::tie(b.file, b.line);
  });
  throw GraphError(std::move(diagnostics));
}

}  // namespace

CompiledGraph compileFile(const std::string& path, const Overrides& overrides, const PassCatalog& catalog,
                          const CompileOptions& options) {
  std::vector<Diagnostic> diagnostics;
  Description description = load(path, diagnostics);
  return compileOrThrow(std::move(description), overrides, catalog, options, std::move(diagnostics));
}

CompiledGraph compileText(const std::string& json, const std::string& file, const Overrides& overrides,
                          const PassCatalog& catalog, const CompileOptions& options) {
  std::vector<Diagnostic> diagnostics;
  Description description = parse(json, file, diagnostics);
  return compileOrThrow(std::move(description), overrides, catalog, options, std::move(diagnostics));
}

}  // namespace weir::graph
