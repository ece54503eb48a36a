// `weir graph check|explain|dot|schema`: what the compiler makes of a graph, without a device.
#include "commands.h"
#include "graph_options.h"

#include <weir/graph/schema.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <functional>
#include <memory>
#include <utility>

namespace {

using weir::graph::CompiledGraph;

/// `gap` stands between the answers for several graphs.
void addOne(CLI::App& parent, const char* name, const char* help, const char* gap,
            std::function<std::string(const CompiledGraph&)> print) {
  auto options = std::make_shared<GraphOptions>();
  CLI::App* command = parent.add_subcommand(name, help);
  addGraphOptions(*command, *options);
  command->callback([options, gap, print = std::move(print)] {
    weir::Registry registry(weir::pluginSearchPath(options->pluginPath));
    const char* between = "";
    for (const CompiledGraph& compiled : options->compile(registry))
      fmt::print("{}{}", std::exchange(between, gap), print(compiled));
  });
}

std::string checked(const CompiledGraph& graph) {
  return fmt::format("{}: no findings ({} passes run, {} skipped, {} resources)\n", graph.file, graph.passes.size(),
                     graph.skipped.size(), graph.resources.size());
}

void addSchema(CLI::App& parent) {
  struct Options {
    std::string file;
    std::vector<std::string> pluginPath;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = parent.add_subcommand("schema", "print the JSON Schema of graphs over every pass that is found");
  command->add_option("GRAPH", options->file, "ignored: one schema serves all graphs");
  addPluginPath(*command, options->pluginPath);
  command->callback([options] {
    weir::Registry registry(weir::pluginSearchPath(options->pluginPath));
    fmt::print("{}", weir::graph::schemaJson(registry.catalog()));
  });
}

}  // namespace

void addGraphCommand(CLI::App& app) {
  CLI::App* graph = app.add_subcommand("graph", "check a graph and say what it does, without rendering");
  graph->require_subcommand(1);
  addOne(*graph, "check", "report everything that is wrong with a graph", "", checked);
  addOne(*graph, "explain", "order, barriers, lives and memory of resources, history and skipped passes", "\n\n",
         weir::graph::explain);
  addOne(*graph, "dot", "the graph in Graphviz's language", "", weir::graph::dot);
  addSchema(*graph);
}
