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

}  // namespace

const GraphOutput* CompiledGraph::findOutput(const std::string& outputName) const {
  const auto found = std::find_if(outputs.begin(), outputs.end(),
                                  [&](const GraphOutput& output) { return output.name == outputName; });
  return found == outputs.end() ? nullptr : &*found;
}

CompiledGraph compile(const Description& description, const PassCatalog& catalog, uint32_t width, uint32_t height,
                      std::vector<Diagnostic>& diagnostics) {
  CompiledGraph graph;
  graph.name = description.name;
  graph.file = description.file;
  graph.width = width;
  graph.height = height;
  Findings findings(description.file, diagnostics);
  if (description.broken) return graph;
  checkFrameSize(width, height, findings);
  Checked checked = bind(description, catalog, findings);
  resolve(checked, findings);
  matchPorts(checked, findings);
  findCycles(checked, findings);
  if (description.outputs.empty() && !findings.any())
    findings.add(0, "outputs", "there is no output; expected at least one");
  if (findings.any()) return graph;
  plan(checked, orderPasses(checked), graph, findings);
  if (!findings.any()) planBarriers(graph);
  return graph;
}

CompiledGraph compileFile(const std::string& path, const Overrides& overrides, const PassCatalog& catalog,
                          uint32_t width, uint32_t height) {
  std::vector<Diagnostic> diagnostics;
  Description description = load(path, diagnostics);
  apply(description, overrides, diagnostics);
  CompiledGraph graph = compile(description, catalog, width, height, diagnostics);
  if (diagnostics.empty()) return graph;
  // In the file's order, which is how somebody will go through them.
  std::stable_sort(diagnostics.begin(), diagnostics.end(), [](const Diagnostic& a, const Diagnostic& b) {
    return std::tie(a.file, a.line) < std::tie(b.file, b.line);
  });
  throw GraphError(std::move(diagnostics));
}

}  // namespace weir::graph
