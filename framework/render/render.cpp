#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/core/text.h>
#include <weir/execute/executor.h>
#include <weir/graph/compile.h>
#include <weir/image/statistics.h>
#include <weir/pass/registry.h>
#include <weir/render/mean.h>
#include <weir/render/picture_header.h>
#include <weir/render/render.h>
#include <weir/render/statistics.h>
#include <weir/render/write_file.h>

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>

namespace weir::render {
namespace {

using Clock = std::chrono::steady_clock;
double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void checkOptions(const RenderOptions& o) {
  if (o.width == 0 || o.height == 0 || o.width > 16384 || o.height > 16384) {
    throw InputError(fmt::format("--size {}x{}: each side must be 1 … 16384", o.width, o.height));
  }
  if (o.frames == 0) throw InputError("--frames must be at least 1");
  if (o.restarts == 0) throw InputError("--restarts must be at least 1");
  if (o.average == 0 || o.average > o.frames)
    throw InputError(fmt::format("--average {}: must be 1 … --frames {}", o.average, o.frames));
  requireFrameNumbers(o.firstFrame, "--frames", o.frames);
  if (!o.errors.empty() && o.restarts < 2) throw InputError("--stderr needs --restarts 2 or more");
  std::vector<NamedPath> written;
  for (const auto* list : {&o.outputs, &o.errors}) {
    for (const auto& [name, file] : *list) {
      const std::string extension = std::filesystem::path(file).extension().string();
      if (extension != ".exr" && (extension != ".png" || list == &o.errors)) {
        throw InputError(
            fmt::format("{}={}: the file must end in .exr{}", name, file, list == &o.errors ? "" : " or .png"));
      }
      checkWritable(file);
      written.emplace_back(fmt::format("{} {}", list == &o.errors ? "--stderr" : "--out", name), file);
    }
  }
  if (!o.statistics.empty()) checkWritable(o.statistics);
  written.emplace_back("--stats", o.statistics);
  requireDistinct(written,
                  {{"the graph", o.graph}, {"--scene", o.stage.scene}, {"--environment", o.stage.environment}});
}

/// `--exposure`: a --set for every tone map that has the parameter.
graph::Overrides withExposure(const RenderOptions& o) {
  graph::Overrides result = o.overrides;
  if (!o.exposure) return result;
  std::vector<graph::Diagnostic> ignored;  // compileFile reports them
  for (const graph::PassEntry& pass : graph::load(o.graph, ignored).passes) {
    if (pass.type == "output.Tonemap") result.set.push_back(fmt::format("{}.exposure={}", pass.name, *o.exposure));
  }
  return result;
}

/// The outputs that somebody wants, each name once.
std::vector<std::string> wanted(const RenderOptions& o, const graph::CompiledGraph& graph) {
  std::vector<std::string> names, known;
  for (const graph::GraphOutput& output : graph.outputs) known.push_back(output.name);
  for (const auto* list : {&o.outputs, &o.errors}) {
    for (const auto& [name, file] : *list) {
      if (graph.findOutput(name) == nullptr) {
        const std::string nearest = nearestName(name, known);
        throw InputError(fmt::format("graph {} has no output '{}'{}", o.graph, name,
                                     nearest.empty() ? "" : " (nearest: '" + nearest + "')"));
      }
      const graph::Resource& resource = graph.resources[graph.findOutput(name)->resource];
      if (resource.type.kind != PortKind::Image) {
        throw InputError(fmt::format("output '{}' ({}) is a buffer, not a picture", name, resource.name));
      }
      if (std::ranges::count(names, name) == 0) names.push_back(name);
    }
  }
  return names;
}

/// The moments that the outputs show.
std::string animationOf(const RenderOptions& o, const Stage& stage) {
  const uint64_t last = uint64_t{o.firstFrame} + o.frames - 1;
  const std::string label = animationLabel(stage, last + 1 - o.average, last);
  return label.empty() ? "none" : label;
}

RunFacts::Environment environmentFacts(const Stage& stage) {
  const scene::Environment& e = stage.scene.environment;
  const scene::EnvironmentTable& table = stage.prepared.environment;
  RunFacts::Environment facts{e.path,     e.width,        e.height, table.columns,
                              table.rows, table.integral, 0.0,      stage.environmentSeconds};
  const auto environment = static_cast<uint32_t>(scene::GpuLightKind::Environment);
  for (const scene::GpuLight& light : stage.prepared.lights) {
    if (light.kind == environment) facts.share = light.pdf;
  }
  return facts;
}

/// Renders one frame of `executor` with rays counted, after as many as give the history its usual length.
uint64_t countRays(const gpu::Device& device, shader::Compiler& compiler, Registry& registry,
                   const scene::SceneGpu& scene, const graph::CompiledGraph& graph, execute::ExecutorOptions options,
                   const Stage& stage, uint32_t frames) {
  options.countRays = true;
  execute::Executor executor(device, compiler, registry, scene, graph, options);
  Player player(stage);
  for (uint32_t f = 0; f < std::min(frames, 3u); ++f) executor.frame(player.frame(f, 0));
  executor.finish();
  return executor.rays();
}

uint64_t peakHostBytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return uint64_t{1024} * static_cast<uint64_t>(usage.ru_maxrss);  // Linux counts in KiB
}

}  // namespace

uint32_t restartSeed(uint32_t seed, uint32_t restart) {
  if (restart == 0) return seed;
  uint64_t z = (uint64_t{seed} << 32) + restart + 0x9e3779b97f4a7c15ull;  // splitmix64
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return static_cast<uint32_t>((z ^ (z >> 31)) >> 16);
}

void render(const RenderOptions& o) {
  checkOptions(o);
  const Clock::time_point begin = Clock::now();
  Registry registry(pluginSearchPath(o.pluginPaths));
  const graph::CompiledGraph compiled =
      graph::compileFile(o.graph, withExposure(o), registry.catalog(), o.width, o.height);
  const std::vector<std::string> names = wanted(o, compiled);

  const Stage stage = makeStage(o.stage, static_cast<float>(o.width) / static_cast<float>(o.height));
  if (o.warn) {
    for (const std::string& warning : stage.scene.warnings) o.warn(warning);
    if (stage.prepared.lights.empty())
      o.warn("the scene has no lights: the picture will be black (--lights N adds some)");
  }
  gpu::DeviceOptions deviceOptions;
  deviceOptions.choice = o.device;
  deviceOptions.validation = o.validation;
  const gpu::Device device(deviceOptions);
  const trace::Backend backend = trace::chooseBackend(o.trace, device);

  RunFacts facts;
  Clock::time_point start = Clock::now();
  const scene::SceneGpu scene(device, stage.scene, stage.prepared, device.capabilities().accelerationStructure);
  facts.uploadSeconds = secondsSince(start);
  start = Clock::now();
  shader::Compiler compiler;
  execute::ExecutorOptions executorOptions;
  executorOptions.backend = backend;
  executorOptions.sceneFolder = std::filesystem::path(o.stage.scene).parent_path().string();
  execute::Executor executor(device, compiler, registry, scene, compiled, executorOptions);
  facts.compileSeconds = secondsSince(start);

  Player player(stage);
  std::map<std::string, image::RestartAccumulator> means;
  std::vector<execute::FrameTimes> times;
  std::map<std::string, FrameMean> window;
  executor.captureTo(names, [&](const std::string& name, const image::Picture& picture) { window[name].add(picture); });
  for (uint32_t r = 0; r < o.restarts; ++r) {
    executor.resetHistory();
    window.clear();
    for (uint32_t f = 0; f < o.frames; ++f) {
      executor.frame(player.frame(o.firstFrame + f, restartSeed(o.seed, r)), f + o.average >= o.frames);
      if (r == 0 && f == 0 && !o.statistics.empty()) {
        executor.finish();
        facts.firstFrameSeconds = secondsSince(begin);
      }
      for (execute::FrameTimes& t : executor.takeTimes()) times.push_back(std::move(t));
      if (o.progress) o.progress(uint64_t{r} * o.frames + f + 1, uint64_t{o.restarts} * o.frames);
    }
    executor.finish();
    for (const std::string& name : names) means[name].add(window[name].mean());
    for (execute::FrameTimes& t : executor.takeTimes()) times.push_back(std::move(t));
  }

  const PictureFacts pictured{.graphFile = o.graph,
                              .camera = stage.cameraLabel,
                              .lights = stage.lightsLabel,
                              .animation = animationOf(o, stage),
                              .seed = o.seed,
                              .restarts = o.restarts,
                              .frames = o.frames,
                              .firstFrame = o.firstFrame,
                              .average = o.average};
  const std::map<std::string, std::string> attributes = pictureHeader(pictured, stage, executor.graph());
  auto write = [&](image::Picture picture, const std::string& file, Meaning meaning) {
    picture.attributes = attributes;
    if (file.ends_with(".png")) {
      writePng(file, picture, meaning == Meaning::Display ? image::Encoding::Display : image::Encoding::Radiance);
    } else {
      writeExr(file, picture);
    }
  };
  for (const auto& [name, file] : o.outputs) write(means[name].mean(), file, executor.meaning(name));
  for (const auto& [name, file] : o.errors) write(means[name].standardError(), file, Meaning::Data);

  if (!o.statistics.empty()) {
    facts.device = device.info().name;
    facts.driver = device.info().driver;
    facts.trace = trace::backendName(backend);
    facts.scene = stage.sceneLabel;
    facts.lights = stage.lightsLabel;
    facts.animation = animationOf(o, stage);
    facts.environment = environmentFacts(stage);
    facts.importTimes = stage.importTimes;
    facts.accelerationSeconds = scene.accelerationSeconds;
    facts.uploadSeconds -= facts.accelerationSeconds;
    facts.peakHostBytes = peakHostBytes();
    facts.prepareSeconds = stage.prepareSeconds;
    facts.sceneBytes = scene.bytes() + executor.motionBytes();
    facts.transientBytes = executor.transientBytes();
    facts.historyBytes = executor.historyBytes();
    facts.savedBytes = executor.savedBytes();
    facts.rays = countRays(device, compiler, registry, scene, compiled, executorOptions, stage, o.frames);
    writeTextFile(o.statistics, statisticsJson(executor.graph(), times, facts));
  }
  if (o.validation && !device.validationMessages().empty()) {
    std::string text = "validation layers complain:";
    for (const gpu::ValidationMessage& m : device.validationMessages()) text += "\n" + m.text;
    throw RuntimeError(text);
  }
}

}  // namespace weir::render
