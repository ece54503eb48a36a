#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/core/parallel.h>
#include <weir/core/paths.h>
#include <weir/render/laboratory.h>
#include <weir/render/lanes.h>
#include <weir/render/render.h>
#include <weir/trace/acceleration.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <utility>

namespace weir::render {

Laboratory::Laboratory(const std::vector<std::string>& pluginPaths) : registry_(pluginSearchPath(pluginPaths)) {}

graph::CompiledGraph Laboratory::compile(const std::string& file, const graph::Overrides& overrides, uint32_t width,
                                         uint32_t height) {
  return graph::compileFile(file, overrides, registry_.catalog(), width, height);
}

void Laboratory::open(const StageOptions& stage, const DeviceChoice& choice, float aspect) {
  scene_.reset();
  stage_ = makeStage(stage, aspect);
  sceneFolder_ = std::filesystem::path(stage.scene).parent_path().string();
  if (!device_) {
    gpu::DeviceOptions options;
    options.choice = choice.device;
    options.validation = choice.validation;
    device_ = std::make_unique<gpu::Device>(options);
    backend_ = trace::chooseBackend(choice.trace, *device_);
  }
  scene_ = std::make_unique<scene::SceneGpu>(*device_, stage_->scene, stage_->prepared,
                                             device_->capabilities().accelerationStructure);
}

void Laboratory::requireNoValidationMessages() const {
  if (device_->validationMessages().empty()) return;
  std::string text = "validation layers complain:";
  for (const gpu::ValidationMessage& m : device_->validationMessages()) text += "\n" + m.text;
  throw RuntimeError(text);
}

std::unique_ptr<execute::Executor> Laboratory::executor(graph::CompiledGraph graph, uint32_t lanes, bool countRays) {
  execute::ExecutorOptions options;
  options.backend = backend_;
  options.sceneFolder = sceneFolder_;
  options.lanes = lanes;
  options.countRays = countRays;
  return std::make_unique<execute::Executor>(*device_, compiler_, registry_, *scene_, std::move(graph), options);
}

Restarts::Restarts(Laboratory& laboratory, graph::CompiledGraph graph, const RestartOptions& options)
    : options_(options),
      lanes_(options.lanes == 0 ? lanesThatFill(laboratory.device(), graph) : options.lanes),
      executor_(laboratory.executor(std::move(graph), lanes_)),
      player_(laboratory.stage()),
      means_(lanes_) {
  executor_->captureLanesTo({options_.output},
                            [this](const std::string&, std::span<const image::Picture> lanes) { take(lanes); });
}

void Restarts::take(std::span<const image::Picture> lanes) {
  // Lane by lane on all cores: one core takes longer for a frame's pictures than a GPU for the frame.
  const auto add = [&](size_t lane) { means_[lane].add(lanes[lane]); };
  parallelFor(lanes.size(), std::cref(add));
  if (++delivered_ < (options_.lastOnly ? 1 : options_.frames)) return;
  delivered_ = 0;
  std::vector<image::Picture> wholes(lanes.size());
  parallelFor(lanes.size(), [&](size_t lane) { wholes[lane] = std::exchange(means_[lane], {}).mean(); });
  (*sink_)(wholes);
}

void Restarts::run(uint32_t count, const Sink& sink) {
  sink_ = &sink;
  for (uint32_t left = count; left > 0;) {
    seeds_.resize(std::min(left, lanes_));
    for (uint32_t& seed : seeds_) seed = restartSeed(options_.seed, done_++);
    executor_->resetHistory();
    for (uint32_t f = 0; f < options_.frames; ++f) {
      execute::FrameInput input = player_.frame(options_.firstFrame + f, 0);
      input.laneSeeds = seeds_;
      executor_->frame(input, !options_.lastOnly || f + 1 == options_.frames);
    }
    left -= static_cast<uint32_t>(seeds_.size());
  }
  executor_->finish();
  sink_ = nullptr;
}

std::string bundledGraph(const std::string& name) {
  const std::filesystem::path own = libraryFolder();
  // Build tree, bundle, installations with lib and with lib/<architecture>.
  for (const char* folder : {"graphs", "../graphs", "../share/weir/graphs", "../../share/weir/graphs"}) {
    const std::filesystem::path file = own / folder / name;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(file, ignored)) return file.lexically_normal().string();
  }
  throw InputError(fmt::format("no graph {} beside {}", name, own.string()));
}

}  // namespace weir::render
