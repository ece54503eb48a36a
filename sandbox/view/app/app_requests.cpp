// Carrying out what the user asked for. Whatever goes wrong is a message, and what was there before goes on.
#include "view/app/app.h"
#include "view/app/app_guard.h"
#include "view/document/render_command.h"

#include <weir/core/error.h>
#include <weir/render/picture_header.h>
#include <weir/render/reference_picture.h>
#include <weir/render/write_file.h>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace weir::view {
namespace {

namespace fs = std::filesystem;

}  // namespace

void App::carryOut(const Request& request) {
  std::visit(Each{[this](const OpenGraph& r) { openGraph(r.file); },
                  [this](const OpenScene& r) { openScene(r.file); },
                  [this](const SaveGraph& r) { quit_ |= saveGraph(r.file) && closes_; },
                  [this](const Revert&) {
                    if (guard("file", [&] { document_.reread(); })) runDocument();
                  },
                  [this](const OpenSecond& r) { openSecond(r.file); },
                  [this](const SetReference& r) { setReference(r.file); },
                  [this](const SaveTrail& r) {
                    guard("compare", [&] {
                      render::writeTextFile(r.file, comparison_->trail().csv());
                      messages_.add(Severity::Info, "compare", "points → " + r.file);
                    });
                  },
                  [this](const SaveShot& r) { saveShot(r.file); },
                  [this](const SaveSequence& r) {
                    guard("sequence", [&] {
                      fs::create_directories(r.folder);
                      engine_->restart();
                      sequence_ = Sequence{r.folder, r.frames, 0};
                      engine_->step();
                    });
                  },
                  [this](const CopyCommand&) {
                    guard("command", [&] {
                      const std::string text = renderCommandText();
                      window_.setClipboard(text);
                      messages_.add(Severity::Info, "command", text);
                    });
                  },
                  [this](const Quit&) {
                    if (document_.changed())
                      asksToClose_ = true;
                    else
                      quit_ = true;
                  },
                  [this](const SetPaused& r) { engine_->setPaused(r.paused); },
                  [this](const StepFrame&) { engine_->step(); },
                  [this](const Restart&) {
                    engine_->restart();
                    comparison_->restarted(engine_->graph());
                  },
                  [this](const RunFrames& r) {
                    engine_->runFrames(r.frames);
                    comparison_->restarted(engine_->graph());
                  },
                  [this](const SetCountRays& r) {
                    if (guard("graph", [&] { engine_->countRays(r.count); })) graphChanged();
                  },
                  [this](const SetPacing& r) { presenter_->swapchain().setPacing(static_cast<Pacing>(r.pacing)); },
                  [this](const SetRenderScale& r) { renderScale_ = std::clamp(r.scale, 0.1f, 2.0f); },
                  [this](const SetFixedSize& r) { fixedSize_ = r.size; },
                  [this](const ChooseCamera& r) { chooseCamera(r.index); },
                  [this](const SetFieldOfView& r) { camera_->setFieldOfView(r.degrees); },
                  [this](const SetSpeed& r) { camera_->setSpeed(r.metresPerSecond); },
                  [this](const SetLight& r) { guard("light", [&] { engine_->setLight(r.index, r.light); }); },
                  [this](const SetSeconds& r) { engine_->setSeconds(r.seconds); },
                  [this](const SetPlays& r) { engine_->setPlays(r.plays); },
                  [this](const ChooseClip& r) {
                    render::StageOptions options = engine_->stageOptions();
                    options.animate = r.index >= 0;
                    options.clip = r.index >= 0 ? std::to_string(r.index) : "";
                    reloadStage(options);
                  },
                  [this](const SetSceneLights& r) {
                    render::StageOptions options = engine_->stageOptions();
                    options.lights = r.count;
                    options.lightSeed = r.seed;
                    options.replaceLights = r.count > 0;
                    reloadStage(options);
                  },
                  [this](const Dismiss& r) { messages_.dismiss(r.message); },
                  [this](const CancelWork&) { sequence_.reset(); }},
             request);
}

/// The document first, then what runs. A document that does not compile stays as it is, with what is wrong said at its
/// passes, while the last graph that did runs on.
void App::carryOutEdit(const Edit& edit) {
  const SwapContext context{catalog_, engine_->size().x, engine_->size().y};
  const std::string before = valueOf(edit);
  if (!guard("edit", [&] { view::carryOut(document_, context, edit); })) return;
  messages_.clear("edit");
  runDocument();
  if (graphProblems_.empty()) tellTurned(edit, before);
}

void App::runDocument() {
  graphProblems_.clear();
  try {
    engine_->setGraph(document_.text());
    messages_.clear("graph");
  } catch (const graph::GraphError& error) {
    graphProblems_ = problemsOf(error.diagnostics());
    messages_.add(Severity::Error, "graph", error.what());
  } catch (const std::exception& error) {
    messages_.add(Severity::Error, "graph", error.what());
  }
  graphChanged();
}

void App::openGraph(const std::string& file) {
  const bool opened = guard("file", [&] {
    Document document = Document::load(file);
    // What is not saved stays where it is: a graph that is dropped on the window does not take it away.
    if (document_.changed())
      throw InputError(
          document_.file() +
          " has changes that are not saved: save them (Ctrl+S) or undo them (Ctrl+Z) before another graph is opened");
    engine_->openGraph(file, document.text());
    document_ = std::move(document);
  });
  if (!opened) return;
  messages_.clear("file");
  messages_.clear("graph");
  graphProblems_.clear();
  recent_.add(file);
  graphChanged();
  comparison_->restarted(engine_->graph());
}

void App::openScene(const std::string& file) {
  render::StageOptions options = engine_->stageOptions();
  // Cameras, clips and generated lights belong to the scene that was there.
  options.scene = file;
  options.camera.clear();
  options.animate = false;
  options.clip.clear();
  options.lights = 0;
  options.replaceLights = false;
  reloadStage(options);
}

void App::reloadStage(const render::StageOptions& options) {
  render::StageOptions wanted = options;
  // The camera stays where the user has put it, in the same scene.
  if (wanted.scene == engine_->stageOptions().scene) wanted.camera = camera_->text();
  const glm::uvec2 size = engine_->size();
  loader_.load(wanted, static_cast<float>(size.x) / static_cast<float>(size.y));
}

void App::openSecond(const std::string& file) {
  if (file.empty()) {
    picture_->showNothingBeside();
    guard("compare", [&] { engine_->openSecond(""); });
    return;
  }
  guard("compare", [&] {
    if (!file.ends_with(".json")) {
      const image::Picture picture = image::readPicture(file);
      picture_->showPicture(device_, picture, file);
      engine_->openSecond("");
      // Radiance beside radiance.
      const std::string port = PictureView::radiancePort(engine_->graph());
      if (!port.empty()) picture_->show(*engine_, port);
      return;
    }
    engine_->openSecond(file);
    picture_->showSecond(*engine_);
    messages_.clear("compare");
  });
}

bool App::saveGraph(const std::string& file) {
  const bool saved = guard("file", [&] {
    if (file.empty() || file == document_.file()) {
      document_.save();
    } else {
      document_.saveAs(file);
      engine_->openGraph(file, document_.text());
    }
    messages_.add(Severity::Info, "file", document_.file() + ": saved");
  });
  closes_ = closes_ && saved;
  if (!saved) return false;
  recent_.add(document_.file());
  graphChanged();
  return true;
}

void App::writeOutput(const std::string& output, const std::string& file) {
  execute::Executor& executor = engine_->executor();
  executor.finish();
  image::Picture picture = executor.read(output);
  const render::Stage& stage = engine_->stage();
  render::PictureFacts facts;
  facts.graphFile = document_.file();
  facts.camera = render::cameraLabel(engine_->lastInput().camera);
  facts.lights = stage.lightsLabel + (engine_->lightsEdited() ? ", edited" : "");
  if (stage.playback)
    facts.animation =
        fmt::format("{} at {:.6g} s", stage.scene.clips[stage.playback->clip].name, engine_->shownSeconds());
  facts.seed = engine_->seed();
  facts.frames = engine_->frames();
  facts.firstFrame = engine_->firstFrame();
  picture.attributes = render::pictureHeader(facts, stage, executor.graph());
  if (file.ends_with(".png"))
    image::writePng(
        file, picture,
        executor.meaning(output) == Meaning::Display ? image::Encoding::Display : image::Encoding::Radiance);
  else if (file.ends_with(".exr"))
    image::writeExr(file, picture);
  else
    throw InputError(file + ": the file must end in .exr or .png");
}

/// The shown port, where it is an output of the graph's; else the output that suits the file: light for EXR, what a
/// screen shows for PNG.
void App::saveShot(const std::string& file) {
  guard("screenshot", [&] {
    const graph::CompiledGraph& graph = engine_->graph();
    std::string best;
    int rank = -1;
    for (const graph::GraphOutput& output : graph.outputs) {
      const graph::Resource& resource = graph.resources[output.resource];
      if (!resource.isImage()) continue;
      const Meaning meaning = meaningOf(graph, resource);
      const bool shown = resource.name == picture_->a().port;
      const bool suits = file.ends_with(".exr") ? meaning == Meaning::Radiance : meaning == Meaning::Display;
      const int is = (suits ? 2 : 0) + (shown ? 1 : 0);
      if (is > rank) {
        rank = is;
        best = output.name;
      }
    }
    if (best.empty()) throw InputError("the graph has no picture among its outputs");
    writeOutput(best, file);
    messages_.add(Severity::Info, "screenshot", fmt::format("{} → {}", best, file));
  });
}

/// A frame after its rendering: written, and the next one begun.
void App::continueSequence() {
  if (!sequence_ || engine_->frames() <= sequence_->next) return;
  const std::string file = fmt::format("{}/frame_{:05}.png", sequence_->folder, sequence_->next);
  const bool written = guard("sequence", [&] {
    for (const graph::GraphOutput& output : engine_->graph().outputs) {
      const graph::Resource& resource = engine_->graph().resources[output.resource];
      if (resource.isImage() && meaningOf(engine_->graph(), resource) == Meaning::Display) {
        writeOutput(output.name, file);
        return;
      }
    }
    throw InputError("the graph has no output that a screen could show: a sequence is made of those");
  });
  if (!written) {
    sequence_.reset();
    return;
  }
  if (++sequence_->next == sequence_->frames) {
    messages_.add(Severity::Info, "sequence", fmt::format("{} frames → {}", sequence_->frames, sequence_->folder));
    sequence_.reset();
    return;
  }
  engine_->step();
}

void App::chooseCamera(int index) {
  const render::Stage& stage = engine_->stage();
  if (index < 0) {
    camera_->frame(static_cast<float>(engine_->size().x) / static_cast<float>(engine_->size().y));
    return;
  }
  if (static_cast<size_t>(index) >= stage.scene.cameras.size()) return;
  const scene::Camera camera = stage.scene.cameras[static_cast<size_t>(index)];
  engine_->setSceneCamera(camera);
  camera_->set(camera, camera.name);
}

std::string App::renderCommandText() {
  render::RenderOptions view = options_.render;
  view.graph = document_.file();
  view.stage = engine_->stageOptions();
  view.stage.camera = camera_->text();
  view.width = engine_->size().x;
  view.height = engine_->size().y;
  view.frames = std::max(engine_->frames(), 1u);
  view.firstFrame = engine_->firstFrame();
  view.seed = engine_->seed();
  view.outputs.clear();
  for (const graph::GraphOutput& output : engine_->graph().outputs)
    if (engine_->graph().resources[output.resource].isImage())
      view.outputs.emplace_back(output.name, output.name + ".exr");
  const std::optional<scene::Camera> camera = camera_->untouched() ? std::nullopt : std::optional(camera_->camera());
  const RenderCommand command = renderCommand(document_, catalog_, view, camera);
  std::string remarks;
  if (!command.saveFirst.empty()) remarks += "\n# save the graph first: " + command.saveFirst;
  for (const std::string& unsaid : command.unsaid) remarks += "\n# not said: " + unsaid;
  if (engine_->lightsEdited()) remarks += "\n# not said: lights were edited in the window";
  return command.text + remarks;
}

/// `--out` and `--stats`, as the window is closed.
void App::writeOutputsAtEnd() {
  for (const auto& [output, file] : options_.render.outputs) writeOutput(output, file);
  if (!options_.render.statistics.empty()) writeMeasurement(options_.render.statistics);
}

}  // namespace weir::view
