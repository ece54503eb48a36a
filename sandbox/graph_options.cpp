#include "graph_options.h"

#include <weir/core/error.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <charconv>
#include <utility>

void GraphOptions::parseSize(uint32_t& width, uint32_t& height) const {
  const char *begin = size.data(), *end = begin + size.size();
  const auto [x, widthError] = std::from_chars(begin, end, width);
  if (widthError == std::errc() && x != end && (*x == 'x' || *x == 'X')) {
    const auto [rest, heightError] = std::from_chars(x + 1, end, height);
    if (heightError == std::errc() && rest == end && width > 0 && height > 0) return;
  }
  throw weir::InputError(fmt::format("--size: '{}' is no size; expected WxH, as 1280x720", size));
}

std::vector<weir::graph::CompiledGraph> GraphOptions::compile(weir::Registry& registry) const {
  uint32_t width = 0, height = 0;
  parseSize(width, height);
  std::vector<weir::graph::CompiledGraph> graphs;
  std::vector<weir::graph::Diagnostic> findings;
  for (const std::string& file : files) {
    try {
      graphs.push_back(weir::graph::compileFile(file, overrides, registry.catalog(), width, height));
    } catch (const weir::graph::GraphError& error) {
      findings.insert(findings.end(), error.diagnostics().begin(), error.diagnostics().end());
    }
  }
  if (!findings.empty()) throw weir::graph::GraphError(std::move(findings));
  return graphs;
}

void addPluginPath(CLI::App& command, std::vector<std::string>& pluginPath) {
  command
      .add_option(
          "--plugin-path", pluginPath,
          "folder with plugins, searched before WEIR_PLUGIN_PATH and the folder of Weir itself; may be repeated")
      ->type_name("DIR")
      ->allow_extra_args(false);
}

void addGraphOptions(CLI::App& command, GraphOptions& options) {
  command.add_option("GRAPH", options.files, "the graph's JSON file; may be several")->required();
  command.add_option("--set", options.overrides.set, "change a parameter: pass.param=value; may be repeated")
      ->type_name("PASS.PARAM=VALUE")
      ->allow_extra_args(false);
  command.add_option("--enable", options.overrides.enable, "enable a pass; may be repeated")
      ->type_name("PASS")
      ->allow_extra_args(false);
  command.add_option("--disable", options.overrides.disable, "disable a pass; may be repeated")
      ->type_name("PASS")
      ->allow_extra_args(false);
  command.add_option("--size", options.size, "the frame's size")->type_name("WxH")->capture_default_str();
  addPluginPath(command, options.pluginPath);
}
