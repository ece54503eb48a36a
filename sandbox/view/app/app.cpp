#include "view/app/app.h"

#include "view/app/app_guard.h"
#include "view/document/overrides.h"
#include "view/ui/style.h"

#include <weir/core/error.h>
#include <weir/render/write_file.h>

#include <fmt/format.h>
#include <imgui.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <utility>

namespace weir::view {
namespace {

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Of this thread alone: what the window costs is the same however busy the machine is.
double cpuMilliseconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

gpu::DeviceOptions deviceOptions(const ViewOptions& options, const WindowSystem& system) {
  gpu::DeviceOptions device;
  device.choice = options.render.device;
  device.validation = options.render.validation;
  device.windowExtensions = system.vulkanExtensions();
  return device;
}

/// The graph as the command line means it. `--exposure` is a parameter of every tone map.
Document openDocument(const ViewOptions& options, Registry& registry) {
  Document document = Document::load(options.render.graph);
  graph::Overrides overrides = options.render.overrides;
  if (options.render.exposure)
    for (const graph::PassEntry& pass : document.description().passes)
      if (pass.type == "output.Tonemap")
        overrides.set.push_back(fmt::format("{}.exposure={}", pass.name, *options.render.exposure));
  applyOverrides(document, overrides, registry.catalog());
  return document;
}

Pacing pacingOf(const std::string& word) {
  if (word == "vsync") return Pacing::VSync;
  if (word == "newest") return Pacing::Newest;
  if (word == "immediate") return Pacing::Immediate;
  throw InputError(fmt::format("--pacing '{}': is none of vsync, newest, immediate", word));
}

}  // namespace

App::App(const ViewOptions& options)
    : options_(options),
      marks_(!options.script.empty()),
      window_(system_, "weir", options.window),
      registry_(pluginSearchPath(options.render.pluginPaths)),
      device_(deviceOptions(options, system_)),
      document_(openDocument(options, registry_)),
      catalog_(registry_.catalog()) {
  const render::RenderOptions& r = options_.render;
  if (!options.script.empty()) startScript();
  scale_ = options.scale > 0.0f ? options.scale : window_.contentScale();
  platform_ =
      std::make_unique<UiPlatform>(scale_, Clipboard{[this] { return window_.clipboard(); },
                                                     [this](const std::string& text) { window_.setClipboard(text); }});
  presenter_ = std::make_unique<Presenter>(device_, window_, pacingOf(options.pacing));
  menuHeight_ = 22.0f * scale_;
  layout_ = layoutOf(glm::vec2(window_.size()), menuHeight_, scale_, layoutState_);
  if (options.sizeGiven) fixedSize_ = {r.width, r.height};
  askedSize_ = wantedSize();

  const auto aspect = static_cast<float>(askedSize_.x) / static_cast<float>(askedSize_.y);
  auto stage = std::make_unique<render::Stage>(render::makeStage(r.stage, aspect));
  for (const std::string& warning : stage->scene.warnings) messages_.add(Severity::Warning, "scene", warning);
  if (stage->prepared.lights.empty())
    messages_.add(Severity::Warning, "scene", "the scene has no lights: the picture is black (Scene panel, Lights)");
  EngineOptions engine;
  engine.graphFile = r.graph;
  engine.graphJson = document_.text();
  engine.size = askedSize_;
  engine.seed = r.seed;
  engine.firstFrame = r.firstFrame;
  engine.backend = trace::chooseBackend(r.trace, device_);
  engine_ = std::make_unique<Engine>(device_, registry_, engine, r.stage, std::move(stage));
  picture_ = std::make_unique<PictureView>(device_, compiler_);
  comparison_ = std::make_unique<Comparison>(device_);
  references_ = bundledReferences();
  recent_.add(r.graph);
  recent_.add(r.stage.scene);
  sceneChanged();
  graphChanged();
  if (!options.second.empty()) openSecond(options.second);
  if (!options.reference.empty()) setReference(options.reference);
  if (options.framesGiven) engine_->runFrames(r.frames);
}

App::~App() {
  device_.waitIdle();
}

void App::startScript() {
  ScriptHost host;
  host.setWindowSize = [this](glm::ivec2 size) { window_.setSize(size); };
  host.minimise = [this](bool is) { window_.minimise(is); };
  host.framesRendered = [this] { return engine_->frames(); };
  host.idle = [this] { return !loader_.loading() && !sequence_; };
  host.messages = [this](bool problemsOnly) {
    std::vector<std::string> texts;
    for (const Message& message : messages_.all())
      if (!problemsOnly || message.severity != Severity::Info) texts.push_back(message.topic + ": " + message.text);
    return texts;
  };
  host.shoot = [this](const std::string& file) {
    shotFile_ = file;
    presenter_->requestShot();
  };
  host.shooting = [this] { return !shotFile_.empty(); };
  host.measure = [this](const std::string& file) { writeMeasurement(file); };
  host.quit = [this] { quit_ = true; };
  script_ = std::make_unique<ScriptPlayer>(readScript(options_.script), options_.script, marks_, std::move(host));
}

void App::run() {
  while (!quit_) frame();
  writeOutputsAtEnd();
  if (options_.render.validation && !device_.validationMessages().empty()) {
    std::string text = "validation layers complain:";
    for (const gpu::ValidationMessage& m : device_.validationMessages()) text += "\n" + m.text;
    throw RuntimeError(text);
  }
}

void App::frame() {
  const bool minimised = window_.framebufferSize().x == 0;
  // Nothing moves while it is paused or minimised: the processor has other things to do.
  const bool rests = (engine_->paused() || minimised) && !script_ && !loader_.loading() && !sequence_;
  window_.poll(minimised ? 0.1 : rests ? 0.03 : 0.0);
  frameSeconds_ = secondsSince(lastFrame_);
  lastFrame_ = Clock::now();
  for (const Event& event : window_.takeEvents()) handle(event);
  if (script_) {
    for (const Event& event : script_->next()) handle(event);
    if (script_->done()) script_.reset();
  }
  if (minimised) return;

  const double start = cpuMilliseconds();
  drawUi();
  times_.addUi(cpuMilliseconds() - start);
  messages_.expire();
  fly(frameSeconds_);
  if (const std::optional<std::string> port = std::exchange(shownPort_, std::nullopt))
    guard("picture", [&] { picture_->show(*engine_, *port); });
  for (const Edit& edit : std::exchange(edits_, {})) carryOutEdit(edit);
  if (!choicesOf_.empty()) graphChanged();
  for (const Request& request : std::exchange(requests_, {})) carryOut(request);
  followFiles(false);
  followScene();
  followSize();
  renderFrame();
  present();
  continueSequence();
}

void App::drawUi() {
  const glm::ivec2 size = window_.size(), pixels = window_.framebufferSize();
  if (options_.scale <= 0.0f && std::abs(window_.contentScale() - scale_) > 0.01f) {
    // It was moved to another display.
    scale_ = window_.contentScale();
    platform_->setScale(scale_);
    presenter_->renewFonts();
  }
  marks_.begin(script_ && script_->looks());
  platform_->beginFrame(glm::vec2(size), glm::vec2(pixels) / glm::max(glm::vec2(size), 1.0f), frameSeconds_);
  Ui ui{marks_, scale_};
  if (layoutState_.all) {
    for (Request& request : drawMenu(ui)) requests_.push_back(std::move(request));
  }
  layout_ = layoutOf(glm::vec2(size), menuHeight_, scale_, layoutState_);
  marks_.place("picture", layout_.picture);
  for (Request& request : drawPanels(ui)) requests_.push_back(std::move(request));
  ImGui::Render();
  window_.setCursor(ImGui::GetMouseCursor());
}

glm::uvec2 App::wantedSize() const {
  if (fixedSize_.x > 0) return fixedSize_;
  const glm::vec2 perUnit = glm::vec2(window_.framebufferSize()) / glm::max(glm::vec2(window_.size()), 1.0f);
  const glm::vec2 size = glm::round(layout_.picture.size() * perUnit * renderScale_);
  return glm::uvec2(glm::clamp(size, glm::vec2(16.0f), glm::vec2(16384.0f)));
}

/// Memory is laid out anew for each size: not for every frame of a window that is being drawn larger.
void App::followSize() {
  const glm::uvec2 size = wantedSize();
  stillFrames_ = size == askedSize_ ? stillFrames_ + 1 : 0;
  askedSize_ = size;
  constexpr int kStill = 4;
  if (size == engine_->size() || stillFrames_ < kStill) return;
  if (guard("size", [&] { engine_->setSize(size); })) graphChanged();
}

void App::renderFrame() {
  const std::optional<scene::Camera> camera = camera_->untouched() ? std::nullopt : std::optional(camera_->camera());
  bool isNew = false;
  if (!guard("frame", [&] { isNew = engine_->advance(camera); })) engine_->setPaused(true);
  compare(isNew, takeTimes());
}

std::vector<execute::FrameTimes> App::takeTimes() {
  std::vector<execute::FrameTimes> taken = engine_->executor().takeTimes();
  for (const execute::FrameTimes& times : taken) times_.add(times);
  const double rate = frameSeconds_ > 0.0 ? 1.0 / frameSeconds_ : 0.0;
  framesPerSecond_ += 0.05f * (static_cast<float>(rate) - framesPerSecond_);
  return taken;
}

void App::present() {
  const glm::vec2 perUnit = glm::vec2(window_.framebufferSize()) / glm::max(glm::vec2(window_.size()), 1.0f);
  const glm::vec2 low = layout_.picture.low * perUnit, size = layout_.picture.size() * perUnit;
  const Rect rect{static_cast<int32_t>(low.x), static_cast<int32_t>(low.y),
                  static_cast<uint32_t>(std::max(size.x, 0.0f)), static_cast<uint32_t>(std::max(size.y, 0.0f))};
  std::optional<PixelPlace> probe = pinned_;
  if (!probe && overPicture(mouse_)) probe = picture_->pixelAt(toCanvas(mouse_));
  guard("window", [&] {
    presenter_->show(
        [&](VkCommandBuffer commands, uint32_t slot, const gpu::Image& canvas) {
          // What can't be shown is said, and the frame of the window is finished all the same.
          guard("picture", [&] { picture_->compose(commands, slot, canvas, rect, *engine_, probe); });
        },
        ImGui::GetDrawData());
  });
  if (const std::optional<image::Picture> shot = presenter_->takeShot(); shot && !shotFile_.empty()) {
    guard("screenshot", [&] { image::writePng(shotFile_, *shot, image::Encoding::Display); });
    shotFile_.clear();
  }
}

void App::followFiles(bool now) {
  constexpr double kEvery = 0.25;
  if (!now && secondsSince(lastPoll_) < kEvery) return;
  lastPoll_ = Clock::now();
  std::vector<live::Event> events;
  if (!guard("files", [&] { events = engine_->poll(); })) return;
  if (events.empty()) return;
  for (const live::Event& event : events) {
    const char* topic = event.kind == live::Event::Kind::Graph    ? "graph file"
                        : event.kind == live::Event::Kind::Plugin ? "plugin"
                                                                  : "shader";
    std::string files;
    for (const std::string& file : event.files)
      files += (files.empty() ? "" : ", ") + std::filesystem::path(file).filename().string();
    if (!event.error.empty()) {
      messages_.add(Severity::Error, topic, event.error);
    } else if (event.kind != live::Event::Kind::Graph) {
      messages_.add(Severity::Info, topic, files + ": read again");
    }
    if (event.kind != live::Event::Kind::Graph || !event.error.empty() || !document_.fileDiffers()) continue;
    if (document_.changed()) {
      messages_.add(
          Severity::Warning, topic,
          document_.file() +
              " was changed by somebody else. Your own changes are kept; File, Revert takes what the file says.");
    } else if (guard(topic, [&] {
                 document_.reread();
                 engine_->setGraph(document_.text());
               })) {
      messages_.add(Severity::Info, topic, files + ": read again");
    }
  }
  graphChanged();
}

void App::followScene() {
  std::optional<SceneLoader::Loaded> loaded = loader_.take();
  if (!loaded) return;
  if (loaded->stage == nullptr) {
    messages_.add(Severity::Error, "scene", loaded->error);
    return;
  }
  const std::vector<std::string> warnings = loaded->stage->scene.warnings;
  // What compares looks at the scene that is about to go.
  const std::string reference = referenceFile_;
  setReference("");
  const bool taken = guard("scene", [&] { engine_->setStage(loaded->options, std::move(loaded->stage)); });
  if (!reference.empty()) setReference(reference);
  if (!taken) return;
  messages_.clear("scene");
  recent_.add(loaded->options.scene);
  std::string all;
  for (const std::string& warning : warnings) all += (all.empty() ? "" : "\n") + warning;
  if (engine_->stage().prepared.lights.empty())
    all +=
        (all.empty() ? "" : "\n") + std::string("the scene has no lights: the picture is black (Scene panel, Lights)");
  if (!all.empty()) messages_.add(Severity::Warning, "scene", all);
  sceneChanged();
  graphChanged();
}

void App::sceneChanged() {
  const render::Stage& stage = engine_->stage();
  camera_ = std::make_unique<CameraControl>(stage.camera, engine_->stageOptions().camera, stage.prepared.bounds);
  sceneModel_ = describe(stage, engine_->stageOptions(), engine_->sceneGpu().bytes());
  canMove_.clear();
  for (size_t i = 0; i < stage.scene.lights.size(); ++i) canMove_.push_back(engine_->canMove(i));
  sceneState_.light = 0;
  pinned_.reset();
}

void App::graphChanged() {
  std::vector<std::string> names;
  for (const graph::CompiledPass& pass : engine_->graph().passes) names.push_back(pass.name);
  guard("picture", [&] { picture_->follow(*engine_); });
  times_.setPasses(names);
  const SwapContext context{catalog_, engine_->size().x, engine_->size().y};
  graphModel_ = buildModel({document_, context, &engine_->graph(), graphProblems_, std::exchange(choicesOf_, {})});
  window_.setTitle(title());
}

std::string App::title() const {
  return fmt::format("{}{} - {} - weir", std::filesystem::path(document_.file()).filename().string(),
                     document_.changed() ? "*" : "",
                     std::filesystem::path(engine_->stageOptions().scene).filename().string());
}

void App::writeMeasurement(const std::string& file) {
  std::vector<double> ui = times_.takeUi();
  std::ranges::sort(ui);
  nlohmann::ordered_json json;
  json["frames"] = ui.size();
  const auto at = [&](double share) {
    return ui.empty() ? 0.0 : ui[static_cast<size_t>(std::lround(share * static_cast<double>(ui.size() - 1)))];
  };
  json["ui_cpu_ms"] = {{"median", at(0.5)}, {"p95", at(0.95)}, {"p99", at(0.99)}, {"most", at(1.0)}};
  json["window"] = {window_.size().x, window_.size().y};
  render::writeTextFile(file, json.dump(2) + "\n");
}

void view(const ViewOptions& options) {
  App app(options);
  app.run();
}

}  // namespace weir::view
