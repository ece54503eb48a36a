// `weir render`.
#include <fmt/format.h>
#include <unistd.h>
#include <weir/core/error.h>
#include <weir/render/render.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "commands.h"
#include "graph_options.h"
#include "render_options.h"

namespace {

using weir::InputError;

std::pair<std::string, std::string> splitOutput(const std::string& text, const char* flag) {
  const size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos || equals + 1 == text.size()) {
    throw InputError(fmt::format("{} '{}': expected output=file.exr", flag, text));
  }
  return {text.substr(0, equals), text.substr(equals + 1)};
}

struct Words {
  weir::render::RenderOptions options;
  std::string size = "1280x720";
  std::vector<std::string> outputs, errors;
  float exposure = 0.0f;
};

void run(Words& words, bool exposureGiven) {
  weir::render::RenderOptions& o = words.options;
  parseSize(words.size, o.width, o.height);
  for (const std::string& text : words.outputs) o.outputs.push_back(splitOutput(text, "--out"));
  for (const std::string& text : words.errors) o.errors.push_back(splitOutput(text, "--stderr"));
  if (exposureGiven) o.exposure = words.exposure;
  o.warn = [](const std::string& text) { fmt::print(stderr, "warning: {}\n", text); };
  const bool terminal = isatty(fileno(stderr)) != 0;
  if (terminal) {
    o.progress = [](uint64_t done, uint64_t all) {
      fmt::print(stderr, "\r{} of {} frames", done, all);
      if (done == all) fmt::print(stderr, "\n");
      std::fflush(stderr);
    };
  }
  weir::render::render(o);
  for (const auto* list : {&o.outputs, &o.errors}) {
    for (const auto& [name, file] : *list) fmt::print("{} → {}\n", name, file);
  }
}

}  // namespace

void addRenderCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("render", "Render a graph over a scene without a window");
  auto words = std::make_shared<Words>();
  auto& o = words->options;
  command->add_option("graph", o.graph, "Graph, a JSON file")->required();
  command->add_option("--size", words->size, "Width x height in pixels")->capture_default_str();
  command->add_option("--frames", o.frames, "Frames in sequence; outputs are the last one")->capture_default_str();
  command->add_option("--average", o.average, "Outputs are the mean of the last so many frames")->capture_default_str();
  command
      ->add_option("--restarts", o.restarts, "Repeat with independent seeds and cleared history; outputs are the mean")
      ->capture_default_str();
  command->add_option("--first-frame", o.firstFrame, "Number of the first frame")->capture_default_str();
  command->add_option("--seed", o.seed, "Seed of the random numbers")->capture_default_str();
  command->add_option("--out", words->outputs, "output=file.exr or output=file.png")->allow_extra_args(false);
  command->add_option("--stderr", words->errors, "output=file.exr: standard error over the restarts")
      ->allow_extra_args(false);
  addOverrideOptions(*command, o.overrides);
  addStageOptions(*command, o.stage);
  CLI::Option* exposure = command->add_option("--exposure", words->exposure, "EV, for every output.Tonemap");
  addDeviceOptions(*command, o.device, o.trace, o.validation);
  command->add_option("--stats", o.statistics, "JSON file with times, memory and rays");
  addPluginPath(*command, o.pluginPaths);
  command->callback([words, exposure] { run(*words, exposure->count() > 0); });
}
