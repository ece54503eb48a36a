#include "render_options.h"

#include <fmt/format.h>
#include <weir/core/error.h>

#include <CLI/CLI.hpp>
#include <charconv>

namespace {

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

void parseSize(const std::string& text, uint32_t& width, uint32_t& height) {
  const char* end = text.data() + text.size();
  const auto w = std::from_chars(text.data(), end, width);
  if (w.ec == std::errc() && w.ptr != end && *w.ptr == 'x') {
    const auto h = std::from_chars(w.ptr + 1, end, height);
    if (h.ec == std::errc() && h.ptr == end) return;
  }
  throw weir::InputError(fmt::format("--size '{}': expected WIDTHxHEIGHT, such as 1280x720", text));
}

void addOverrideOptions(CLI::App& command, weir::graph::Overrides& overrides) {
  command.add_option("--set", overrides.set, "pass.param=value")->allow_extra_args(false);
  command.add_option("--enable", overrides.enable, "Pass to enable")->allow_extra_args(false);
  command.add_option("--disable", overrides.disable, "Pass to disable")->allow_extra_args(false);
}

void addStageOptions(CLI::App& command, weir::render::StageOptions& stage) {
  command.add_option("--scene", stage.scene, "glTF file")->required();
  command.add_option("--lights", stage.lights, "Put so many point lights into a scene that has none");
  command.add_option("--light-seed", stage.lightSeed, "Seed of their places and colours")->capture_default_str();
  command.add_flag("--replace-lights", stage.replaceLights, "With --lights: drop the scene's own lights");
  command.add_option("--environment", stage.environment, "Light from all around: equirectangular .exr or .hdr");
  command.add_option("--environment-scale", stage.environmentScale, "Multiplies it")->capture_default_str();
  command
      .add_option("--environment-rotation", stage.environmentRotation,
                  "Degrees about +Y, counter-clockwise as seen from above")
      ->capture_default_str();
  command.add_option("--camera", stage.camera, "Name of a camera of the scene, or ex,ey,ez,tx,ty,tz[,vfov degrees]");
  command.add_flag("--energy-compensation", stage.energyCompensation,
                   "Add the light that rough specular surfaces reflect more than once");
  addAnimationOptions(command, stage);
}

void addDeviceOptions(CLI::App& command, std::string& device, std::string& trace, bool& validation) {
  command.add_option("--trace", trace, "auto, pipeline or query")->capture_default_str();
  command.add_option("--device", device, "cpu, a number from `weir devices`, or part of a name");
  command.add_flag("--validate", validation, "Run under the Vulkan validation layers; any message is a failure");
}
