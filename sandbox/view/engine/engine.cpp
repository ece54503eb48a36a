#include "view/engine/engine.h"

#include <weir/core/error.h>
#include <weir/scene/gather_lights.h>

#include <algorithm>
#include <filesystem>
#include <utility>

namespace weir::view {

Engine::Engine(const gpu::Device& device, Registry& registry, const EngineOptions& options,
               const render::StageOptions& stageOptions, std::unique_ptr<render::Stage> stage)
    : device_(device),
      registry_(registry),
      backend_(options.backend),
      graphFile_(options.graphFile),
      graphJson_(options.graphJson),
      seed_(options.seed),
      firstFrame_(options.firstFrame) {
  compile_.width = options.size.x;
  compile_.height = options.size.y;
  secondCompile_ = compile_;
  staged_ = upload(stageOptions, std::move(stage));
  session_ = makeSession(staged_, graphFile_, &graphJson_, compile_);
  if (staged_.stage->playback) seconds_ = staged_.stage->playback->start;
}

Engine::~Engine() {
  device_.waitIdle();
}

Staged Engine::upload(const render::StageOptions& options, std::unique_ptr<render::Stage> stage) const {
  Staged staged;
  staged.options = options;
  staged.stage = std::move(stage);
  staged.gpu = std::make_unique<scene::SceneGpu>(device_, staged.stage->scene, staged.stage->prepared,
                                                 device_.capabilities().accelerationStructure);
  staged.player = std::make_unique<render::Player>(*staged.stage);
  return staged;
}

execute::ExecutorOptions Engine::executorOptions(const Staged& staged) const {
  execute::ExecutorOptions options;
  options.backend = backend_;
  options.countRays = countRays_;
  options.sceneFolder = std::filesystem::path(staged.options.scene).parent_path().string();
  return options;
}

std::unique_ptr<live::Session> Engine::makeSession(const Staged& staged, const std::string& file,
                                                   const std::string* json,
                                                   const graph::CompileOptions& compile) const {
  const execute::ExecutorOptions options = executorOptions(staged);
  if (json == nullptr)
    return std::make_unique<live::Session>(device_, compiler_, registry_, *staged.gpu, file, graph::Overrides{},
                                           compile, options);
  return std::make_unique<live::Session>(device_, compiler_, registry_, *staged.gpu, file, *json, compile, options);
}

/// Without those ports that the graph lacks: they are shown again when it has them.
graph::CompileOptions Engine::keeping(const std::vector<std::string>& ports, const std::string& json) const {
  graph::CompileOptions options = compile_;
  options.keep.clear();
  std::vector<graph::Diagnostic> ignored;
  const graph::Description description = graph::parse(json, graphFile_, ignored);
  for (const std::string& port : ports) {
    const std::optional<graph::Reference> reference = graph::parseReference(port);
    if (!reference) continue;
    const graph::PassEntry* pass = description.find(reference->pass);
    const PassDescription* type = pass == nullptr ? nullptr : registry_.find(pass->type);
    const std::string name = reference->pass + "." + reference->port;
    if (type != nullptr && type->findOutput(reference->port) != nullptr && std::ranges::count(options.keep, name) == 0)
      options.keep.push_back(name);
  }
  return options;
}

void Engine::setGraph(const std::string& json) {
  const graph::CompileOptions options = keeping(kept_, json);
  session_->edit(json, options);
  graphJson_ = json;
  compile_ = options;
}

void Engine::openGraph(const std::string& file, const std::string& json) {
  const std::string before = std::exchange(graphFile_, file);
  try {
    const graph::CompileOptions options = keeping(kept_, json);
    std::unique_ptr<live::Session> session = makeSession(staged_, file, &json, options);
    device_.waitIdle();
    session_ = std::move(session);
    graphJson_ = json;
    compile_ = options;
  } catch (...) {
    graphFile_ = before;
    throw;
  }
  restart();
}

void Engine::setSize(glm::uvec2 size) {
  if (size == this->size()) return;
  graph::CompileOptions options = compile_, second = secondCompile_;
  options.width = second.width = size.x;
  options.height = second.height = size.y;
  session_->edit(graphJson_, options);
  compile_ = options;
  if (second_) second_->change({}, second);
  secondCompile_ = second;
  // A size is another history: a run of so many frames begins again.
  if (left_) runFrames(run_);
}

void Engine::keep(const std::vector<std::string>& ports) {
  if (ports == kept_) return;
  const graph::CompileOptions options = keeping(ports, graphJson_);
  if (options.keep != compile_.keep) session_->edit(graphJson_, options);
  compile_ = options;
  kept_ = ports;
}

void Engine::countRays(bool count) {
  if (count == countRays_) return;
  countRays_ = count;
  try {
    std::unique_ptr<live::Session> session = makeSession(staged_, graphFile_, &graphJson_, compile_);
    device_.waitIdle();
    session_ = std::move(session);
  } catch (...) {
    countRays_ = !count;
    throw;
  }
  restart();
}

void Engine::openSecond(const std::string& file) {
  std::unique_ptr<live::Session> session;
  graph::CompileOptions options = compile_;
  options.keep.clear();
  if (!file.empty()) session = makeSession(staged_, file, nullptr, options);
  device_.waitIdle();
  second_ = std::move(session);
  secondCompile_ = options;
  secondFile_ = file;
  if (second_) restart();
}

void Engine::keepOfSecond(const std::vector<std::string>& ports) {
  if (!second_ || ports == secondCompile_.keep) return;
  graph::CompileOptions options = secondCompile_;
  options.keep = ports;
  second_->change({}, options);
  secondCompile_ = options;
}

std::vector<live::Event> Engine::poll() {
  std::vector<live::Event> events = session_->poll();
  if (second_)
    for (live::Event& event : second_->poll()) events.push_back(std::move(event));
  return events;
}

void Engine::setStage(const render::StageOptions& options, std::unique_ptr<render::Stage> stage) {
  Staged staged = upload(options, std::move(stage));
  std::unique_ptr<live::Session> session = makeSession(staged, graphFile_, &graphJson_, compile_);
  std::unique_ptr<live::Session> second;
  if (second_) second = makeSession(staged, secondFile_, nullptr, secondCompile_);
  device_.waitIdle();
  // Executors first: they refer to the scene.
  session_ = std::move(session);
  second_ = std::move(second);
  staged_.player.reset();
  staged_.gpu.reset();
  staged_ = std::move(staged);
  lastInput_ = {};  // its state was the player's that is gone
  lightsEdited_ = false;
  ++sceneRevision_;
  seconds_ = staged_.stage->playback ? staged_.stage->playback->start : 0.0;
  restart();
}

bool Engine::canMove(size_t light) const {
  return !staged_.stage->prepared.traits.animated || staged_.stage->scene.lights[light].node < 0;
}

void Engine::setLight(size_t index, const scene::PunctualLight& light) {
  scene::setLight(staged_.stage->scene, staged_.stage->prepared, index, light);
  staged_.gpu->updateLights(staged_.stage->prepared);
  lightsEdited_ = true;
  ++sceneRevision_;
}

bool Engine::advance(const std::optional<scene::Camera>& camera) {
  if (paused_) return false;
  const render::Stage& stage = *staged_.stage;
  const uint32_t number = firstFrame_ + frames_;
  execute::FrameInput input =
      stage.playback ? staged_.player->frameAt(seconds_, number, seed_) : staged_.player->frame(number, seed_);
  if (camera) input.camera = *camera;
  session_->executor().frame(input);
  if (second_) second_->executor().frame(input);
  lastInput_ = input;
  shownSeconds_ = seconds_;
  ++frames_;
  if (stage.playback && plays_) seconds_ += stage.playback->step;
  if (left_ && --*left_ == 0) {
    left_.reset();
    paused_ = true;
  }
  if (std::exchange(steps_, false)) paused_ = true;
  return true;
}

void Engine::setPaused(bool paused) {
  paused_ = paused;
  left_.reset();
}

void Engine::step() {
  paused_ = false;
  left_.reset();
  steps_ = true;
}

void Engine::restart() {
  session_->executor().resetHistory();
  if (second_) second_->executor().resetHistory();
  frames_ = 0;
  left_.reset();
  steps_ = false;
  if (staged_.stage->playback) seconds_ = staged_.stage->playback->start;
}

void Engine::runFrames(uint32_t frames) {
  restart();
  paused_ = false;
  run_ = frames;
  if (frames > 0) left_ = frames;
}

void Engine::setSeconds(double seconds) {
  seconds_ = std::max(seconds, 0.0);
}

}  // namespace weir::view
