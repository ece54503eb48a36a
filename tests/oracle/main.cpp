// The CPU oracle as a program, for long runs: pictures with their standard errors, and how they compare with Weir's.
//   oracle --scene scenes/cornell.glb --bounces 4 --size 256 --batches 64 --samples 64 --out o.exr --stderr o-error.exr
//   weir render graphs/reference.json --scene scenes/cornell.glb --set path.maxBounces=4 --size 256x256 --restarts 1024
//               --out radiance=w.exr --stderr radiance=w-error.exr
//   oracle --picture o.exr --picture-stderr o-error.exr --against w.exr --against-stderr w-error.exr
// Exit status 0: done, they agree; 3: they differ; 2: bad input.
#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/image/image.h>
#include <weir/render/stage.h>
#include <weir/render/write_file.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>

#include "comparison.h"
#include "path.h"

namespace {

using namespace weir;

struct Words {
  render::StageOptions stage;
  oracle::Options options{.samples = 64, .batches = 16};
  std::string size = "256x256", out, error, picture, pictureError, against, againstError;
  double tolerance = 0.0;
};

void readSize(const std::string& text, oracle::Options& o) {
  unsigned width = 0, height = 0;
  char rest = 0;
  const int found = std::sscanf(text.c_str(), "%ux%u%c", &width, &height, &rest);
  if (found == 1 && text.find_first_not_of("0123456789") == std::string::npos)
    height = width;
  else if (found != 2)
    throw InputError("--size " + text + ": neither WxH nor a side");
  if (width == 0 || height == 0 || width > 16384 || height > 16384)
    throw InputError("--size " + text + ": each side must be 1 … 16384");
  o.width = width;
  o.height = height;
}

/// What `weir compare` looks at. The framework reads the scene for these words alone: nothing of it reaches the
/// picture.
std::map<std::string, std::string> header(const Words& words) {
  const oracle::Options& o = words.options;
  const float aspect = static_cast<float>(o.width) / static_cast<float>(o.height);
  const render::Stage stage = render::makeStage(words.stage, aspect);
  const std::string animation = render::animationLabel(stage, 0, 0);
  return {{"weir.scene", stage.sceneLabel},
          {"weir.camera", stage.cameraLabel},
          {"weir.lights", stage.lightsLabel},
          {"weir.animation", animation.empty() ? "none" : animation},
          {"weir.graph", fmt::format("CPU oracle, {} bounces", o.bounces)},
          {"weir.params", fmt::format("jitter={}", o.jitter)},
          {"weir.seed", std::to_string(o.seed)},
          {"weir.size", fmt::format("{}x{}", o.width, o.height)},
          {"weir.frames", fmt::format("{} batches of {} paths a pixel", o.batches, o.samples)}};
}

void renderPicture(Words& words, image::Picture& picture, image::Picture& error) {
  const auto start = std::chrono::steady_clock::now();
  std::optional<oracle::Moment> moment;
  if (words.stage.animate) moment = {words.stage.clip, words.stage.time};
  oracle::Model model = oracle::loadModel(words.stage.scene, moment);
  const auto attributes = header(words);
  if (words.stage.lights > 0) oracle::generateLights(model, words.stage.lights, words.stage.lightSeed);
  const oracle::Camera camera = oracle::chooseCamera(model, words.stage.camera);
  const oracle::Tracer tracer(model);
  words.options.progress = [&](uint32_t done) {
    fmt::print(stderr, "\r{} of {} batches", done, words.options.batches);
    if (done == words.options.batches) fmt::print(stderr, "\n");
  };
  const image::RestartAccumulator result = oracle::render(model, tracer, camera, words.options);
  picture = result.mean();
  error = result.standardError();
  picture.attributes = error.attributes = attributes;
  fmt::print("{}: {} triangles, {} punctual lights, {}x{}, {} x {} paths a pixel of up to {} bounces in {:.1f} s\n",
             words.stage.scene, model.triangles.size(), model.lights.size(), words.options.width, words.options.height,
             words.options.batches, words.options.samples, words.options.bounces,
             std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
}

int run(Words& words) {
  image::Picture picture, error;
  if (!words.picture.empty()) {
    picture = image::readExr(words.picture);
    error = image::readExr(words.pictureError);
  } else {
    readSize(words.size, words.options);
    for (const std::string& file : {words.out, words.error})
      if (!file.empty()) render::checkWritable(file);
    renderPicture(words, picture, error);
    if (words.out.ends_with(".png"))
      image::writePng(words.out, picture, image::Encoding::Radiance);
    else if (!words.out.empty())
      image::writeExr(words.out, picture);
    if (!words.error.empty()) image::writeExr(words.error, error);
  }
  if (words.against.empty()) return 0;
  const image::Picture other = image::readExr(words.against), otherError = image::readExr(words.againstError);
  for (const char* key : {"weir.scene", "weir.camera", "weir.lights", "weir.animation"}) {
    const auto& here = picture.attributes;
    const auto& there = other.attributes;
    if (here.contains(key) && there.contains(key) && here.at(key) != there.at(key))
      throw InputError(fmt::format("{} differs: \"{}\" and \"{}\"", key, here.at(key), there.at(key)));
  }
  const oracle::Verdict v = oracle::compare(other, otherError, picture, error, words.options.tile, words.tolerance);
  fmt::print("{}\n", v.text());
  return v.passed ? 0 : 3;
}

}  // namespace

int main(int argc, char** argv) {
  Words words;
  oracle::Options& o = words.options;
  CLI::App app("A path tracer on the CPU that shares no code with Weir's shaders and scenes.");
  auto* scene = app.add_option("--scene", words.stage.scene, "glTF file");
  app.add_option("--lights", words.stage.lights, "Generated lights, as weir render's");
  app.add_option("--light-seed", words.stage.lightSeed);
  app.add_flag("--replace-lights", words.stage.replaceLights);
  app.add_option("--camera", words.stage.camera, "Name or ex,ey,ez,tx,ty,tz[,vfov]");
  app.add_option("--clip", words.stage.clip, "Shows a moment of this clip");
  app.add_option("--time", words.stage.time, "Seconds");
  app.add_option("--bounces", o.bounces, "0: direct light alone");
  app.add_option("--size", words.size, "WxH or a side");
  app.add_option("--samples", o.samples, "Paths a pixel in a batch")->check(CLI::PositiveNumber);
  app.add_option("--batches", o.batches, "Independent ones")->check(CLI::Range(2u, 1000000u));
  app.add_option("--seed", o.seed);
  app.add_flag("--jitter", o.jitter, "Samples over the pixel's box rather than at its centre");
  app.add_flag("!--one-light", o.everyPunctual, "One shadow ray to punctual lights at the first surface too");
  app.add_option("--threads", o.threads, "0: all cores");
  app.add_option("--out", words.out, ".exr or .png");
  app.add_option("--stderr", words.error, ".exr with the standard error of every pixel");
  auto* stored = app.add_option("--picture", words.picture, "An earlier --out in place of a scene")->excludes(scene);
  auto* storedError = app.add_option("--picture-stderr", words.pictureError)->needs(stored);
  stored->needs(storedError);
  auto* against = app.add_option("--against", words.against, "Picture of Weir's to compare with, .exr");
  auto* againstError = app.add_option("--against-stderr", words.againstError, "Its standard error")->needs(against);
  against->needs(againstError);
  app.add_option("--tile", o.tile, "Pixels a side")->check(CLI::PositiveNumber);
  app.add_option("--tolerance", words.tolerance, "Relative difference of a tile that is let pass besides its error");
  CLI11_PARSE(app, argc, argv);
  words.stage.animate = !words.stage.clip.empty();
  words.stage.timeStep = 0.0;
  try {
    if (words.stage.scene.empty() && words.picture.empty()) throw InputError("--scene or --picture is needed");
    return run(words);
  } catch (const InputError& e) {
    fmt::print(stderr, "oracle: {}\n", e.what());
    return 2;
  } catch (const std::exception& e) {
    fmt::print(stderr, "oracle: {}\n", e.what());
    return 1;
  }
}
