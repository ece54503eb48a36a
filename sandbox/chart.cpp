// `weir chart`: what `weir bench` measured, as one page.
#include <fmt/format.h>
#include <weir/chart/chart.h>
#include <weir/core/error.h>
#include <CLI/CLI.hpp>

#include <cstdio>
#include <memory>

#include "commands.h"

namespace {

void run(const weir::chart::Options& options) {
  if (options.page.empty() && options.svg.empty()) throw weir::InputError("neither --out nor --svg: nothing to write");
  const weir::chart::Summary summary = weir::chart::makeChart(options);
  constexpr size_t kMost = 20;  // a folder that was lost would say the same of every configuration
  for (size_t i = 0; i < summary.warnings.size() && i < kMost; ++i)
    fmt::print(stderr, "warning: {}\n", summary.warnings[i]);
  if (summary.warnings.size() > kMost)
    fmt::print(stderr, "warning: and {} more like these\n", summary.warnings.size() - kMost);
  fmt::print("{} configurations, {} scenes, {} pictures\n", summary.configurations, summary.groups, summary.pictures);
}

}  // namespace

void addChartCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("chart", "error against time as one self-contained page");
  const auto options = std::make_shared<weir::chart::Options>();
  const auto megabytes = std::make_shared<size_t>(options->pictureBytes >> 20u);
  command->footer("Exit status: 0 written; 1 failed while running; 2 bad input.");
  command->add_option("files", options->files, "JSON files of weir bench")->required();
  command->add_option("--out", options->page, "the page (HTML)");
  command->add_option("--svg", options->svg, "a still picture of the same, drawn without a browser");
  command->add_option("--title", options->title, "default: what the scenes are");
  command->add_option("--time", options->time,
                      "horizontal axis: frame, no-gbuffer, wall, pass.NAME (default: the first measured)");
  command->add_option("--error", options->error,
                      "vertical axis: relmse.median, relmse_mean64, flip, … (default: the first measured)");
  command->add_option("--picture-limit", *megabytes, "MiB of pictures in the page; those on a Pareto front come first")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->callback([options, megabytes] {
    options->pictureBytes = *megabytes << 20u;
    run(*options);
  });
}
