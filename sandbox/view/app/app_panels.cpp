// What is drawn: menu, columns, overlays. Nothing here changes anything but what is shown; what the user asks for is
// put down in requests_ and edits_.
#include "view/app/app.h"
#include "view/app/app_guard.h"
#include "view/ui/style.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <filesystem>

namespace weir::view {
namespace {

constexpr ImGuiWindowFlags kColumn = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                                     ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoBringToFrontOnFocus;

bool beginColumn(const char* name, const Rectangle& where) {
  ImGui::SetNextWindowPos({where.low.x, where.low.y});
  ImGui::SetNextWindowSize({where.size().x, where.size().y});
  return ImGui::Begin(name, nullptr, kColumn);
}

}  // namespace

void App::drawFileMenu(Ui& ui, Requests& requests) {
  const Marks::Scope scope(ui.marks, "menu/File");
  const auto item = [&](const char* label, const char* keys, const char* name) {
    const bool is = ImGui::MenuItem(label, keys);
    ui.marks.last(name);
    return is;
  };
  const auto ask = [&](FileDialog::For what, const std::string& start) {
    guard("file", [&] { files_.open(what, start); });
  };
  if (item("Open graph…", "Ctrl+O", "open-graph")) ask(FileDialog::For::OpenGraph, document_.file());
  if (item("Open scene…", "Ctrl+Shift+O", "open-scene")) ask(FileDialog::For::OpenScene, engine_->stageOptions().scene);
  if (ImGui::BeginMenu("Recent")) {
    for (const std::string& path : recent_.all()) {
      if (ImGui::MenuItem(path.c_str()))
        requests.push_back(path.ends_with(".json") ? Request(OpenGraph{path}) : Request(OpenScene{path}));
      ui.marks.last("recent/" + path);
    }
    ImGui::EndMenu();
  }
  ui.marks.last("recent");
  ImGui::Separator();
  if (item("Save graph", "Ctrl+S", "save")) requests.push_back(SaveGraph{});
  if (item("Save graph as…", "Ctrl+Shift+S", "save-as")) ask(FileDialog::For::SaveGraph, document_.file());
  if (item("Revert", nullptr, "revert")) requests.push_back(Revert{});
  ImGui::Separator();
  if (item("Save picture…", "Ctrl+P", "save-picture")) ask(FileDialog::For::SaveShot, "picture.png");
  if (item("Save frames…", nullptr, "save-frames")) ask(FileDialog::For::SaveSequence, "frames");
  if (item("Copy weir render command", "Ctrl+C", "copy-command")) requests.push_back(CopyCommand{});
  ImGui::Separator();
  if (item("Quit", "Ctrl+Q", "quit")) requests.push_back(Quit{});
}

void App::drawTimeMenu(Ui& ui, Requests& requests) {
  const Marks::Scope scope(ui.marks, "menu/Time");
  if (ImGui::MenuItem(engine_->paused() ? "Go on" : "Pause", "Space"))
    requests.push_back(SetPaused{!engine_->paused()});
  ui.marks.last("pause");
  if (ImGui::MenuItem("One frame", ".")) requests.push_back(StepFrame{});
  ui.marks.last("step");
  if (ImGui::MenuItem("Restart", "R")) requests.push_back(Restart{});
  ui.marks.last("restart");
  for (const uint32_t frames : {1u, 8u, 32u, 64u, 256u}) {
    const std::string label = fmt::format("Run {} frames and pause", frames);
    if (ImGui::MenuItem(label.c_str())) requests.push_back(RunFrames{frames});
    ui.marks.last(fmt::format("run-{}", frames));
  }
}

Requests App::drawMenu(Ui& ui) {
  Requests requests;
  if (!ImGui::BeginMainMenuBar()) return requests;
  menuHeight_ = ImGui::GetWindowSize().y;
  const auto menu = [&](const char* label, auto draw) {
    const bool open = ImGui::BeginMenu(label);
    ui.marks.last(std::string("menu/") + label);
    if (!open) return;
    draw();
    ImGui::EndMenu();
  };
  menu("File", [&] { drawFileMenu(ui, requests); });
  menu("Edit", [&] {
    if (ImGui::MenuItem(("Undo " + graphModel_.undoes).c_str(), "Ctrl+Z", false, document_.canUndo()))
      edits_.emplace_back(Undo{});
    ui.marks.last("menu/Edit/undo");
    if (ImGui::MenuItem(("Redo " + graphModel_.redoes).c_str(), "Ctrl+Shift+Z", false, document_.canRedo()))
      edits_.emplace_back(Redo{});
    ui.marks.last("menu/Edit/redo");
  });
  menu("View", [&] {
    ImGui::MenuItem("Graph", "F2", &layoutState_.graph);
    ui.marks.last("menu/View/graph");
    ImGui::MenuItem("Side", "F3", &layoutState_.side);
    ui.marks.last("menu/View/side");
    ImGui::MenuItem("Times", "F4", &layoutState_.times);
    ui.marks.last("menu/View/times");
    if (ImGui::MenuItem("Picture alone", "Tab")) layoutState_.all = false;
    ui.marks.last("menu/View/alone");
  });
  menu("Time", [&] { drawTimeMenu(ui, requests); });
  menu("Help", [&] {
    ImGui::MenuItem("Keys and mouse", "F1", &help_);
    ui.marks.last("menu/Help/keys");
  });
  // What the menus leave of the bar says what goes on.
  const std::string state = sequence_ ? fmt::format("writing frame {} of {}", sequence_->next, sequence_->frames)
                            : loader_.loading()
                                ? "loading " + std::filesystem::path(loader_.options().scene).filename().string()
                                : std::string();
  if (!state.empty()) {
    ImGui::SameLine(0.0f, 24.0f * scale_);
    ImGui::TextColored(ImColor(palette().accent), "%s", state.c_str());
    ui.marks.last("menu/state");
    if (sequence_ && ImGui::SmallButton("cancel")) requests.push_back(CancelWork{});
  }
  ImGui::EndMainMenuBar();
  return requests;
}

Requests App::drawSide(Ui& ui) {
  Requests requests;
  if (layout_.side.size().x < 1.0f) return requests;
  if (beginColumn("side", layout_.side) && ImGui::BeginTabBar("tabs")) {
    const auto tab = [&](const char* name, auto draw) {
      const bool open = ImGui::BeginTabItem(name);
      ui.marks.last(std::string("tab/") + name);
      if (!open) return;
      ImGui::BeginChild(name);
      draw();
      ImGui::EndChild();
      ImGui::EndTabItem();
    };
    tab("Picture", [&] { drawPictureTab(ui, requests); });
    tab("Compare", [&] { drawCompareTab(ui, requests); });
    tab("Scene", [&] {
      const render::Stage& stage = engine_->stage();
      ScenePanelModel model;
      model.scene = &sceneModel_;
      model.lights = &stage.scene.lights;
      model.canMove = &canMove_;
      model.fieldOfView = camera_->fieldOfView();
      model.speed = camera_->speed();
      model.camera = camera_->text();
      model.clip = stage.playback ? static_cast<int>(stage.playback->clip) : -1;
      model.seconds = engine_->seconds();
      model.duration = stage.playback ? stage.scene.clips[stage.playback->clip].duration : 0.0;
      model.plays = engine_->plays();
      model.loading = loader_.loading();
      model.generated = engine_->stageOptions().lights;
      model.lightSeed = engine_->stageOptions().lightSeed;
      ImGui::PushItemWidth(-95.0f * ui.scale);
      for (Request& request : drawScenePanel(ui, model, sceneState_)) requests.push_back(std::move(request));
      ImGui::PopItemWidth();
    });
    ImGui::EndTabBar();
  }
  ImGui::End();
  return requests;
}

void App::drawPictureTab(Ui& ui, Requests& requests) {
  const ShownSide& a = picture_->a();
  PicturePanelModel model;
  model.a.ports = a.ports;
  model.a.port = a.port;
  model.a.what = a.what;
  model.a.problem = a.problem;
  model.a.channels = &a.channels;
  model.a.channel = a.channel;
  model.a.mode = a.mode;
  model.a.elements = a.elements;
  model.a.measured = a.measured;
  model.size = engine_->size();
  model.zoom = picture_->zoom();
  model.fitted = picture_->fitted();
  model.renderScale = renderScale_;
  model.fixedSize = fixedSize_;
  model.pixel = pinned_;
  model.pinned = pinned_.has_value();
  if (!model.pixel && overPicture(mouse_)) model.pixel = picture_->pixelAt(toCanvas(mouse_));
  model.words = &picture_->words();
  for (const Pacing pacing : presenter_->swapchain().choices()) {
    model.pacings.emplace_back(pacing == Pacing::VSync ? "V-sync" : pacing == Pacing::Newest ? "newest" : "immediate");
    if (pacing == presenter_->swapchain().pacing()) model.pacing = static_cast<int>(model.pacings.size()) - 1;
  }
  const PicturePanelResult result = drawPicturePanel(ui, model);
  if (result.port) shownPort_ = result.port;
  if (result.channel) picture_->setChannel(*result.channel);
  if (result.mode) picture_->setMode(*result.mode);
  if (result.resetMode) picture_->resetMode();
  if (result.measure) picture_->measure();
  if (result.zoom) picture_->setZoom(*result.zoom);
  if (result.renderScale) requests.push_back(SetRenderScale{*result.renderScale});
  if (result.fixedSize) requests.push_back(SetFixedSize{*result.fixedSize});
  if (result.pacing)
    requests.push_back(
        SetPacing{static_cast<int>(presenter_->swapchain().choices()[static_cast<size_t>(*result.pacing)])});
}

void App::drawGraph(Ui& ui) {
  if (layout_.graph.size().x < 1.0f) return;
  if (beginColumn("graph", layout_.graph)) {
    for (size_t p = 0; p < times_.passes().size(); ++p)
      graphState_.gpuMs[times_.passes()[p]] = times_.passFigures()[p].median;
    if (!times_.hasGpu()) graphState_.gpuMs.clear();
    graphState_.shown = picture_->a().port;
    GraphRequests wanted = drawGraphPanel(ui, graphModel_, graphState_);
    for (Edit& edit : wanted.edits) edits_.push_back(std::move(edit));
    if (!wanted.show.empty()) shownPort_ = wanted.show;
    if (!wanted.choicesOf.empty()) choicesOf_ = wanted.choicesOf;
    if (wanted.save) requests_.push_back(SaveGraph{});
    if (!wanted.saveAs.empty()) requests_.push_back(SaveGraph{wanted.saveAs});
  }
  ImGui::End();
}

/// Between the two sides of the picture, with what they are.
void App::drawSplitLine(Ui& ui) {
  if (!picture_->split || !picture_->beside()) return;
  const Rectangle& where = layout_.picture;
  const float x = where.low.x + picture_->splitAt * where.size().x;
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  draw.AddLine({x, where.low.y}, {x, where.high.y}, IM_COL32(255, 255, 255, 170), 1.5f * ui.scale);
  const auto label = [&](const std::string& text, bool left) {
    const ImVec2 size = ImGui::CalcTextSize(text.c_str());
    const float at = left ? x - size.x - 10.0f * ui.scale : x + 10.0f * ui.scale;
    const float y = where.high.y - size.y - 8.0f * ui.scale;
    draw.AddRectFilled({at - 4.0f, y - 2.0f}, {at + size.x + 4.0f, y + size.y + 2.0f}, IM_COL32(0, 0, 0, 150), 3.0f);
    draw.AddText({at, y}, IM_COL32(235, 235, 235, 255), text.c_str());
  };
  label("A " + std::filesystem::path(document_.file()).filename().string(), true);
  label("B " + std::filesystem::path(picture_->besideName()).filename().string(), false);
  ui.marks.place("split", {{x - 4.0f, where.low.y}, {x + 4.0f, where.high.y}});
}

Requests App::drawPanels(Ui& ui) {
  Requests requests;
  const auto take = [&requests](Requests more) {
    for (Request& request : more) requests.push_back(std::move(request));
  };
  drawSplitLine(ui);
  drawGraph(ui);
  take(drawSide(ui));
  TimePanelModel times;
  times.log = &times_;
  execute::Executor& executor = engine_->executor();
  times.rays = executor.rays();
  times.transientBytes = executor.transientBytes();
  times.historyBytes = executor.historyBytes();
  times.savedBytes = executor.savedBytes();
  times.sceneBytes = engine_->sceneGpu().bytes() + executor.motionBytes();
  times.countsRays = engine_->countsRays();
  times.paused = engine_->paused();
  times.frames = engine_->frames();
  times.framesPerSecond = framesPerSecond_;
  times.device = device_.info().name;
  take(drawTimePanel(ui, layout_.times, times));
  take(drawMessages(ui, layout_.picture, messages_.all()));
  take(drawFileDialog(ui, glm::vec2(window_.size()), files_));
  drawHelp(ui, glm::vec2(window_.size()), help_);
  switch (drawCloseQuestion(ui, glm::vec2(window_.size()), asksToClose_)) {
    case CloseAnswer::Save:
      requests.push_back(SaveGraph{});
      closes_ = true;
      break;
    case CloseAnswer::Discard:
      quit_ = true;
      break;
    default:
      break;
  }
  return requests;
}

}  // namespace weir::view
