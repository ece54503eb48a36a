#include <fmt/format.h>
#include <weir/render/bench_command.h>

#include <algorithm>
#include <string_view>

namespace weir::render {
namespace {

std::string quoted(const std::string& word) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=,:@%+";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string result = "'";
  for (const char c : word) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

class Words {
 public:
  void word(const std::string& text) { line_.append(" ").append(quoted(text)); }
  void flag(const char* name, bool given) {
    if (given) line_ += fmt::format(" {}", name);
  }
  template <typename T>
  void option(const char* name, const T& value) {
    // In one word: a camera may begin with a minus sign.
    line_ += fmt::format(" {}={}", name, quoted(fmt::format("{}", value)));
  }
  template <typename T>
  void unless(const T& usual, const char* name, const T& value) {
    if (value != usual) option(name, value);
  }
  void overrides(const graph::Overrides& o, const char* set) {
    for (const std::string& text : o.set) option(set, text);
    for (const std::string& pass : o.enable) option("--enable", pass);
    for (const std::string& pass : o.disable) option("--disable", pass);
  }
  std::string line() const { return line_; }

 private:
  std::string line_ = "weir bench";
};

void addStage(Words& words, const StageOptions& s) {
  const StageOptions usual;
  words.option("--scene", s.scene);
  words.unless(usual.lights, "--lights", s.lights);
  words.unless(usual.lightSeed, "--light-seed", s.lightSeed);
  words.flag("--replace-lights", s.replaceLights);
  words.unless(usual.environment, "--environment", s.environment);
  words.unless(usual.environmentScale, "--environment-scale", s.environmentScale);
  words.unless(usual.environmentRotation, "--environment-rotation", s.environmentRotation);
  words.unless(usual.camera, "--camera", s.camera);
  words.flag("--energy-compensation", s.energyCompensation);
  words.flag("--animate", s.animate);
  words.unless(usual.clip, "--clip", s.clip);
  words.unless(usual.time, "--time", s.time);
  words.unless(usual.timeStep, "--time-step", s.timeStep);
}

void addReference(Words& words, const BenchReference& r, const BenchSettings& s) {
  if (!r.wanted()) return;
  const BenchReference usual;
  words.unless(usual.file, "--reference", r.file);
  words.flag("--reference-exact", r.exact);
  words.unless(usual.graph, "--reference-graph", r.graph);
  words.overrides(r.overrides, "--reference-set");
  words.unless(usual.frames, "--reference-frames", r.frames);
  words.unless(usual.restarts, "--reference-restarts", r.restarts);
  words.option("--repeats", s.repeats);
  words.option("--error-frames", s.errorFrames);
  words.unless(1u, "--error-every", s.errorEvery);
  words.unless(std::string("radiance"), "--output", s.output);
  words.flag("--no-flip", !s.flip);
  if (s.crop) words.option("--crop", fmt::format("{}", fmt::join(*s.crop, ",")));
}

}  // namespace

std::string benchCommand(const Configuration& configuration, const BenchOptions& options) {
  const BenchPart& part = options.parts[configuration.part];
  const BenchSettings& s = options.settings;
  Words words;
  words.word(configuration.graph);
  addStage(words, part.stage);
  words.option("--size", fmt::format("{}x{}", part.width, part.height));
  words.overrides(configuration.overrides, "--set");
  words.option("--warmup", s.warmup);
  words.option("--frames", s.frames);
  words.unless(0u, "--first-frame", s.firstFrame);
  words.unless(0u, "--seed", s.seed);
  addReference(words, part.reference, s);
  words.flag("--floor", options.floor != nullptr);
  words.unless(std::string(), "--device", options.device.device);
  words.unless(std::string("auto"), "--trace", options.device.trace);
  for (const std::string& folder : options.pluginPaths) words.option("--plugin-path", folder);
  words.option("--out", std::string("point.json"));
  return words.line();
}

}  // namespace weir::render
