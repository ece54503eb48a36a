// `weir-view`: what `weir view` becomes. Exit statuses are weir's: 0 done, 1 failed while running, 2 bad input.
#include "graph_options.h"
#include "render_options.h"
#include "view/app/options.h"

#include <weir/core/error.h>
#include <weir/core/text.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <cstdio>
#include <exception>
#include <string>
#include <vector>

namespace {

enum Status { kDone = 0, kFailed = 1, kBadInput = 2 };

struct Words {
  weir::view::ViewOptions options;
  std::string size, window;
  std::vector<std::string> outputs;
  float exposure = 0.0f;
};

void addOptions(CLI::App& app, Words& words) {
  auto& o = words.options.render;
  app.add_option("graph", o.graph, "Graph, a JSON file")->required();
  app.add_option("--size", words.size, "Width x height of the pictures in pixels, whatever the window's size");
  app.add_option("--window", words.window, "Width x height of the window")->default_str("1600x900");
  app.add_option("--frames", o.frames, "Pause after so many");
  app.add_option("--first-frame", o.firstFrame, "Number of the first frame")->capture_default_str();
  app.add_option("--seed", o.seed, "Seed of the random numbers")->capture_default_str();
  app.add_option("--out", words.outputs, "output=file.exr or output=file.png: written when the window is closed")
      ->allow_extra_args(false);
  addOverrideOptions(app, o.overrides);
  addStageOptions(app, o.stage);
  app.add_option("--exposure", words.exposure, "EV, for every output.Tonemap");
  addDeviceOptions(app, o.device, o.trace, o.validation);
  app.add_option("--stats", o.statistics, "JSON file with what the window took of the CPU, when it is closed");
  addPluginPath(app, o.pluginPaths);
  app.add_option("--reference", words.options.reference, "Graph or picture that errors are measured against");
  app.add_option("--compare", words.options.second, "Graph or picture for the right side");
  app.add_option("--pacing", words.options.pacing, "vsync, newest or immediate")->capture_default_str();
  app.add_option("--ui-scale", words.options.scale, "Of fonts and spaces; without it the display's own");
  app.add_option("--script", words.options.script, "Do what this file says, a step a line (docs/sandbox.md)");
}

void take(Words& words, const CLI::App& app) {
  weir::view::ViewOptions& v = words.options;
  v.sizeGiven = app.count("--size") > 0;
  if (v.sizeGiven) parseSize(words.size, v.render.width, v.render.height);
  if (v.render.width == 0 || v.render.height == 0 || v.render.width > 16384 || v.render.height > 16384)
    throw weir::InputError(fmt::format("--size {}: each side must be 1 … 16384", words.size));
  if (app.count("--window") > 0) {
    uint32_t width = 0, height = 0;
    parseSize(words.window, width, height);
    if (width < 320 || height < 240 || width > 16384 || height > 16384)
      throw weir::InputError(fmt::format("--window {}: must be 320x240 … 16384x16384", words.window));
    v.window = {static_cast<int>(width), static_cast<int>(height)};
  }
  v.framesGiven = app.count("--frames") > 0;
  if (v.framesGiven && v.render.frames == 0) throw weir::InputError("--frames must be at least 1");
  if (app.count("--exposure") > 0) v.render.exposure = words.exposure;
  if (app.count("--ui-scale") > 0 && !(v.scale >= 0.5f && v.scale <= 4.0f))
    throw weir::InputError("--ui-scale must be 0.5 … 4");
  for (const std::string& text : words.outputs) {
    const size_t equals = text.find('=');
    if (equals == 0 || equals == std::string::npos || equals + 1 == text.size())
      throw weir::InputError(fmt::format("--out '{}': expected output=file.exr", text));
    v.render.outputs.emplace_back(text.substr(0, equals), text.substr(equals + 1));
  }
}

int sayParseError(const CLI::App& app, const CLI::ParseError& error) {
  std::string text = error.what();
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  for (const std::string& argument : app.remaining()) {
    const std::string nearest = weir::nearestName(argument.substr(0, argument.find('=')), names);
    if (!nearest.empty()) text += fmt::format(" ('{}': nearest is '{}')", argument, nearest);
  }
  fmt::print(stderr, "weir: {}\nsee: weir view --help\n", text);
  return kBadInput;
}

}  // namespace

// What throws while an error is being said may end the program.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
  CLI::App app("Weir's window: a graph over a scene, to be turned, swapped and looked into.", "weir view");
  Words words;
  addOptions(app, words);
  try {
    app.parse(argc, argv);
    take(words, app);
    weir::view::view(words.options);
    return kDone;
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    return sayParseError(app, error);
  } catch (const weir::InputError& error) {
    fmt::print(stderr, "weir: {}\n", error.what());
    return kBadInput;
  } catch (const std::exception& error) {
    fmt::print(stderr, "weir: {}\n", error.what());
    return kFailed;
  }
}
