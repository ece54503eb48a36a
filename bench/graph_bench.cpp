// How long a graph takes from its JSON text to the plan of its frame.
#include "synthetic.h"

#include <benchmark/benchmark.h>

#include <vector>

namespace weir::bench {
namespace {

using graph::CompiledGraph;
using graph::Description;
using graph::Diagnostic;

constexpr uint32_t kWidth = 1920, kHeight = 1080;

/// A benchmark of a graph that is refused would measure something else.
bool isWhole(benchmark::State& state, const CompiledGraph& graph, const std::vector<Diagnostic>& diagnostics) {
  const size_t expected = static_cast<size_t>(state.range(0)) / kBlock * kRunning;
  if (!diagnostics.empty())
    state.SkipWithError(diagnostics.front().text().c_str());
  else if (graph.passes.size() != expected)
    state.SkipWithError("other passes run than should");
  return diagnostics.empty() && graph.passes.size() == expected;
}

void parseGraph(benchmark::State& state) {
  const std::string text = syntheticGraph(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    std::vector<Diagnostic> diagnostics;
    const Description description = graph::parse(text, "bench.json", diagnostics);
    benchmark::DoNotOptimize(description.passes.data());
    if (!diagnostics.empty() || description.passes.size() != static_cast<size_t>(state.range(0)))
      return state.SkipWithError("the graph was not read as a whole");
  }
  state.SetBytesProcessed(state.iterations() * static_cast<int64_t>(text.size()));
  state.SetComplexityN(state.range(0));
}

void compileGraph(benchmark::State& state) {
  const SyntheticPasses passes;
  const graph::PassCatalog catalog = passes.catalog();
  std::vector<Diagnostic> diagnostics;
  const Description description =
      graph::parse(syntheticGraph(static_cast<int>(state.range(0))), "bench.json", diagnostics);
  for (auto _ : state) {
    const CompiledGraph graph = graph::compile(description, catalog, kWidth, kHeight, diagnostics);
    benchmark::DoNotOptimize(graph.passes.data());
    if (!isWhole(state, graph, diagnostics)) return;
  }
  state.SetComplexityN(state.range(0));
}

void parseAndCompileGraph(benchmark::State& state) {
  const SyntheticPasses passes;
  const graph::PassCatalog catalog = passes.catalog();
  const std::string text = syntheticGraph(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    std::vector<Diagnostic> diagnostics;
    const Description description = graph::parse(text, "bench.json", diagnostics);
    const CompiledGraph graph = graph::compile(description, catalog, kWidth, kHeight, diagnostics);
    benchmark::DoNotOptimize(graph.passes.data());
    if (!isWhole(state, graph, diagnostics)) return;
  }
  state.SetComplexityN(state.range(0));
}

BENCHMARK(parseGraph)->Name("graph/parse")->RangeMultiplier(10)->Range(10, 1000)->Unit(benchmark::kMicrosecond);
BENCHMARK(compileGraph)->Name("graph/compile")->RangeMultiplier(10)->Range(10, 1000)->Unit(benchmark::kMicrosecond);
BENCHMARK(parseAndCompileGraph)
    ->Name("graph/parse+compile")
    ->RangeMultiplier(10)
    ->Range(10, 1000)
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace weir::bench
