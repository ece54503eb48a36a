// Comparing: the right side of the picture, and the error of what is shown.
#include "view/app/app.h"
#include "view/app/app_guard.h"
#include "view/compare/background_reference.h"
#include "view/compare/file_reference.h"
#include "view/panels/compare_panel.h"

#include <weir/core/paths.h>
#include <weir/render/stage.h>

#include <imgui.h>

#include <algorithm>
#include <filesystem>

namespace weir::view {
namespace {

namespace fs = std::filesystem;

}  // namespace

std::vector<std::pair<std::string, std::string>> App::bundledReferences() {
  std::vector<std::pair<std::string, std::string>> found;
  for (const auto& [what, name] :
       {std::pair("direct light", "all_lights.json"), std::pair("all light, by path tracing", "reference.json")}) {
    for (const fs::path& folder : {resourceFolder() / "graphs", resourceFolder() / "../../share/weir/graphs"}) {
      std::error_code ignored;
      if (!fs::exists(folder / name, ignored)) continue;
      found.emplace_back(what, (folder / name).lexically_normal().string());
      break;
    }
  }
  return found;
}

void App::compare(bool isNew, const std::vector<execute::FrameTimes>& times) {
  if (!engine_->executor().runtime().recorded()) return;
  ComparedFrame frame;
  frame.input = engine_->lastInput();
  frame.size = engine_->size();
  frame.seconds = engine_->shownSeconds();
  frame.scene = engine_->sceneRevision();
  frame.isNew = isNew;
  frame.times = times;
  guard("compare", [&] {
    const std::string port = PictureView::radiancePort(engine_->graph());
    if (!port.empty()) frame.picture = engine_->executor().locate(port);
    comparison_->frame(frame);
  });
}

void App::setReference(const std::string& file) {
  guard("reference", [&] {
    std::unique_ptr<Reference> reference;
    const glm::uvec2 size = engine_->size();
    if (!file.empty() && file.ends_with(".json")) {
      reference = std::make_unique<BackgroundReference>(
          ReferenceServices{device_, compiler_, registry_, engine_->sceneGpu(), engine_->executorOptions()},
          ReferenceGraph{.file = file, .overrides = {}, .output = "radiance", .shownSeed = engine_->seed()},
          engine_->lastInput(), size.x, size.y);
    } else if (!file.empty()) {
      const render::Stage& stage = engine_->stage();
      const std::string animation =
          stage.playback ? render::animationLabel(stage, engine_->firstFrame(), engine_->firstFrame()) : "none";
      reference = std::make_unique<FileReference>(device_, file, stage, animation, size.x, size.y);
    }
    if (showsReference_) picture_->showNothingBeside();
    comparison_->setReference(std::move(reference));
    referenceFile_ = file;
    messages_.clear("reference");
    if (showsReference_ && !file.empty()) showReference();
    if (file.empty()) showsReference_ = false;
  });
}

void App::showReference() {
  guard("reference", [&] {
    // Radiance beside radiance.
    const std::string port = PictureView::radiancePort(engine_->graph());
    if (!port.empty()) picture_->show(*engine_, port);
    picture_->showSource(
        [this]() -> std::optional<execute::Executor::Located> {
          return comparison_->reference() != nullptr ? comparison_->reference()->image() : std::nullopt;
        },
        referenceFile_);
    showsReference_ = true;
  });
}

/// What the document says now where the edit will change it, in words.
std::string App::valueOf(const Edit& edit) const {
  return std::visit(Each{[&](const SetParam& e) {
                           const PassModel* pass = graphModel_.find(e.pass);
                           if (pass == nullptr) return std::string();
                           for (const ParamModel& param : pass->params)
                             if (param.description.name == e.param) return toText(param.value);
                           return std::string();
                         },
                         [&](const ResetParam& e) {
                           const PassModel* pass = graphModel_.find(e.pass);
                           if (pass == nullptr) return std::string();
                           for (const ParamModel& param : pass->params)
                             if (param.description.name == e.param) return toText(param.value);
                           return std::string();
                         },
                         [](const SetEnabled& e) { return std::string(e.enabled ? "off" : "on"); },
                         [&](const SwapType& e) {
                           const PassModel* pass = graphModel_.find(e.pass);
                           return pass == nullptr ? std::string() : pass->type;
                         },
                         [](const auto&) { return std::string("before"); }},
                    edit);
}

/// The trail has a new setting. Called once the graph runs with it.
void App::tellTurned(const Edit& edit, const std::string& before) {
  const KnobChange change = std::visit(Each{[&](const SetParam& e) {
                                              return KnobChange{e.pass + "." + e.param, before, toText(e.value)};
                                            },
                                            [&](const ResetParam& e) {
                                              return KnobChange{e.pass + "." + e.param, before, valueOf(edit)};
                                            },
                                            [&](const SetEnabled& e) {
                                              return KnobChange{e.pass, before, e.enabled ? "on" : "off"};
                                            },
                                            [&](const SwapType& e) {
                                              return KnobChange{e.pass, before, e.type};
                                            },
                                            [&](const Undo&) {
                                              return KnobChange{"undo", "before", graphModel_.redoes};
                                            },
                                            [&](const Redo&) {
                                              return KnobChange{"redo", "before", graphModel_.undoes};
                                            }},
                                       edit);
  comparison_->turned(change, engine_->graph());
}

void App::drawCompareTab(Ui& ui, Requests& requests) {
  const Marks::Scope scope(ui.marks, "compare");
  const auto button = [&](const char* label, const char* name, const char* help) {
    const bool is = ImGui::Button(label);
    ui.marks.last(name);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", help);
    return is;
  };
  ImGui::TextDisabled("right side");
  ImGui::SameLine();
  ImGui::TextUnformatted(picture_->beside() ? fs::path(picture_->besideName()).filename().c_str() : "nothing");
  ui.marks.last("beside");
  if (button("file…", "open", "A second graph over the same scene, or a picture"))
    guard("file", [&] { files_.open(FileDialog::For::OpenSecond, document_.file()); });
  ImGui::SameLine();
  ImGui::BeginDisabled(comparison_->reference() == nullptr);
  if (button("reference", "show-reference", "The reference that errors are measured against")) showReference();
  ImGui::EndDisabled();
  if (picture_->beside()) {
    ImGui::SameLine();
    if (button("none", "none", "The whole picture is the graph's again")) {
      showsReference_ = false;
      requests.push_back(OpenSecond{});
    }
    ImGui::SameLine();
    ImGui::Checkbox("split (C)", &picture_->split);
    ui.marks.last("split");
  }
  ImGui::Separator();
  if (++comparisonAge_ >= 6 || comparisonState_.points.empty()) {
    // Its words and points are made anew a few times a second.
    comparisonState_ = comparison_->state();
    comparisonAge_ = 0;
  }
  ComparePanelModel model;
  model.state = &comparisonState_;
  model.references = references_;
  model.reference = referenceFile_;
  if (const auto* background = dynamic_cast<const BackgroundReference*>(comparison_->reference()))
    model.frameMilliseconds = background->frameMilliseconds();
  const ComparePanelResult result = drawComparePanel(ui, model);
  if (result.reference) requests.push_back(SetReference{*result.reference});
  if (result.browse) guard("file", [&] { files_.open(FileDialog::For::OpenReference, document_.file()); });
  if (result.budget) comparison_->setBudget(*result.budget);
  if (result.flip) comparison_->setFlip(*result.flip);
  if (result.startOver) requests.push_back(SetReference{referenceFile_});
  if (result.forgetTrail) comparison_->trail().forgetOld();
  if (result.copyTrail) window_.setClipboard(comparison_->trail().csv());
  if (result.saveTrail) guard("file", [&] { files_.open(FileDialog::For::SaveTrail, "points.csv"); });
}

}  // namespace weir::view
