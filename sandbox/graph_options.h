// The options that say which graph is meant and what the command line changes in it: shared by every command that takes
// a graph.
#pragma once

#include <weir/graph/compile.h>
#include <weir/pass/registry.h>

#include <cstdint>
#include <string>
#include <vector>

namespace CLI {
class App;
}

struct GraphOptions {
  std::vector<std::string> files;
  weir::graph::Overrides overrides;
  std::string size = "1280x720";
  std::vector<std::string> pluginPath;

  /// Throws InputError unless `size` reads "WxH".
  void parseSize(uint32_t& width, uint32_t& height) const;
  /// The compiled graphs, or one GraphError with what is wrong with any of them. The registry must outlive them.
  std::vector<weir::graph::CompiledGraph> compile(weir::Registry& registry) const;
};

/// --plugin-path
void addPluginPath(CLI::App& command, std::vector<std::string>& pluginPath);
/// GRAPH..., --set, --enable, --disable, --size, --plugin-path
void addGraphOptions(CLI::App& command, GraphOptions& options);
