// `weir render`.
#include <fmt/format.h>
#include <unistd.h>
#include <weir/core/error.h>
#include <weir/render/render.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdio>
#include <memory>

#include "commands.h"

namespace {

using weir::InputError;

std::pair<std::string, std::string> splitOutput(const std::string& text, const char* flag) {
  const size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos || equals + 1 == text.size()) {
    throw InputError(fmt::format("{} '{}': expected output=file.exr", flag, text));
  }
  return {text.substr(0, equals), text.substr(equals + 1)};
}

void parseSize(const std::string& text, uint32_t& width, uint32_t& height) {
  const char* end = text.data() + text.size();
  const auto w = std::from_chars(text.data(), end, width);
  if (w.ec == std::errc() && w.ptr != end && *w.ptr == 'x') {
    const auto h = std::from_chars(w.ptr + 1, end, height);
    if (h.ec == std::errc() && h.ptr == end) return;
  }
  throw InputError(fmt::format("--size '{}': expected WIDTHxHEIGHT, such as 1280x720", text));
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

void addAnimationOptions(CLI::App& command, weir::render::StageOptions& stage) {
  CLI::Option* animate =
      command.add_flag("--animate", stage.animate, "Play a clip of the scene: frame i shows time + i * time step");
  command.add_option("--clip", stage.clip, "Its name, or its number from 0; without it the first")->needs(animate);
  command.add_option("--time", stage.time, "Where in the clip frame 0 is, seconds")
      ->capture_default_str()
      ->needs(animate);
  command.add_option("--time-step", stage.timeStep, "Seconds from frame to frame")
      ->capture_default_str()
      ->needs(animate);
}

}  // namespace

void addRenderCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("render", "Render a graph over a scene without a window");
  auto words = std::make_shared<Words>();
  auto& o = words->options;
  command->add_option("graph", o.graph, "Graph, a JSON file")->required();
  command->add_option("--scene", o.stage.scene, "glTF file")->required();
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
  command->add_option("--set", o.overrides.set, "pass.param=value")->allow_extra_args(false);
  command->add_option("--enable", o.overrides.enable, "Pass to enable")->allow_extra_args(false);
  command->add_option("--disable", o.overrides.disable, "Pass to disable")->allow_extra_args(false);
  command->add_option("--lights", o.stage.lights, "Put so many point lights into a scene that has none");
  command->add_option("--light-seed", o.stage.lightSeed, "Seed of their places and colours")->capture_default_str();
  command->add_flag("--replace-lights", o.stage.replaceLights, "With --lights: drop the scene's own lights");
  command->add_option("--environment", o.stage.environment, "Light from all around: equirectangular .exr or .hdr");
  command->add_option("--environment-scale", o.stage.environmentScale, "Multiplies it")->capture_default_str();
  command
      ->add_option("--environment-rotation", o.stage.environmentRotation,
                   "Degrees about +Y, counter-clockwise as seen from above")
      ->capture_default_str();
  command->add_option("--camera", o.stage.camera, "Name of a camera of the scene, or ex,ey,ez,tx,ty,tz[,vfov degrees]");
  command->add_flag("--energy-compensation", o.stage.energyCompensation,
                    "Add the light that rough specular surfaces reflect more than once");
  addAnimationOptions(*command, o.stage);
  CLI::Option* exposure = command->add_option("--exposure", words->exposure, "EV, for every output.Tonemap");
  command->add_option("--trace", o.trace, "auto, pipeline or query")->capture_default_str();
  command->add_option("--device", o.device, "cpu, a number from `weir devices`, or part of a name");
  command->add_option("--stats", o.statistics, "JSON file with times, memory and rays");
  command->add_option("--plugin-path", o.pluginPaths, "Folder with plugins, searched first")->allow_extra_args(false);
  command->add_flag("--validate", o.validation, "Run under the Vulkan validation layers; any message is a failure");
  command->callback([words, exposure] { run(*words, exposure->count() > 0); });
}
