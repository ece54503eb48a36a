#include "view/panels/compare_panel.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "view/panels/trail_plot.h"
#include "view/ui/style.h"

namespace weir::view {
namespace {

void paragraph(ImU32 color, const std::string& text) {
  ImGui::PushStyleColor(ImGuiCol_Text, color);
  ImGui::PushTextWrapPos(0.0f);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::PopStyleColor();
}

void tooltip(const char* text) {
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", text);
}

void chooseReference(Ui& ui, const ComparePanelModel& model, ComparePanelResult& result) {
  const std::string shown =
      model.reference.empty() ? "none" : std::filesystem::path(model.reference).filename().string();
  if (ImGui::BeginCombo("reference", shown.c_str(), ImGuiComboFlags_HeightLarge)) {
    if (ImGui::Selectable("none", model.reference.empty())) result.reference = "";
    ui.marks.last("reference/none");
    for (const auto& [what, file] : model.references) {
      if (ImGui::Selectable(what.c_str(), file == model.reference)) result.reference = file;
      ui.marks.last("reference/" + what);
      tooltip(file.c_str());
    }
    if (ImGui::Selectable("a graph or an EXR…")) result.browse = true;
    ui.marks.last("reference/file");
    ImGui::EndCombo();
  }
  ui.marks.last("reference");
}

void reference(Ui& ui, const ComparePanelModel& model, ComparePanelResult& result) {
  const ComparisonState& state = *model.state;
  if (!state.problem.empty()) paragraph(palette().bad, state.problem);
  if (!state.compares) return;
  paragraph(ImGui::GetColorU32(ImGuiCol_Text), state.words);
  ui.marks.last("words");
  if (!state.warning.empty()) paragraph(palette().warning, state.warning);
  auto budget = static_cast<float>(state.budget);
  if (ImGui::SliderFloat("spared", &budget, 0.0f, 50.0f, "%.1f ms"))
    result.budget = static_cast<double>(std::clamp(budget, 0.0f, 1000.0f));
  ui.marks.last("budget");
  tooltip("GPU time that each frame of the window spares for the reference; 0: it rests");
  if (model.frameMilliseconds) {
    ImGui::TextDisabled("a frame of it takes %.3g ms", *model.frameMilliseconds);
    ui.marks.last("cost");
  }
  if (ImGui::SmallButton("start over")) result.startOver = true;
  ui.marks.last("start-over");
}

void row(Ui& ui, const char* name, const char* format, double value, const char* doc) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::TextDisabled("%s", name);
  tooltip(doc);
  ImGui::TableNextColumn();
  if (std::isfinite(value))
    ImGui::Text(format, value);
  else
    ImGui::TextUnformatted("–");
  ui.marks.last(name);
}

void figures(Ui& ui, const ComparisonState& state, ComparePanelResult& result) {
  if (!state.error) {
    ImGui::TextDisabled("nothing is measured yet");
    return;
  }
  const ErrorFigures& e = *state.error;
  if (!e.problem.empty()) return paragraph(palette().bad, e.problem);
  if (ImGui::BeginTable("figures", 2, ImGuiTableFlags_SizingFixedFit)) {
    row(ui, "relMSE", "%.4g", e.relMse, "mean of (a - b)² / (b² + 0.01) over pixels and colours");
    row(ui, "trimmed", "%.4g", e.relMseTrimmed, "relMSE without the worst 0.1 % of pixels");
    row(ui, "bias", "%+.3f %%", 100.0 * e.relativeBias, "of the mean luminance");
    if (state.flip && state.flip->problem.empty()) {
      row(ui, "FLIP", "%.4f", state.flip->mean,
          "HDR-FLIP: how visible the difference is, 0 to 1; of a frame a while ago");
      row(ui, "FLIP p99", "%.4f", state.flip->p99, "of the pixels' FLIP, the 99th percentile");
    }
    ImGui::EndTable();
  }
  // Of what is measured the reference's own error is a part.
  if (std::isfinite(e.referenceRelMse) && e.relMse < 2.0 * e.referenceRelMse)
    paragraph(palette().warning, "most of that may be the reference's own noise");
  if (e.nonFinite > 0)
    ImGui::TextColored(ImColor(palette().bad), "%llu pixels are not finite",
                       static_cast<unsigned long long>(e.nonFinite));
  if (state.flip && !state.flip->problem.empty()) paragraph(palette().bad, "FLIP: " + state.flip->problem);
  bool flip = state.flips;
  if (ImGui::Checkbox("FLIP", &flip)) result.flip = flip;
  ui.marks.last("flip");
  tooltip("keeps other cores busy; of large pictures it takes seconds");
}

void trail(Ui& ui, const ComparisonState& state, ComparePanelResult& result) {
  const ImVec2 low = ImGui::GetCursorScreenPos();
  const float width = std::max(ImGui::GetContentRegionAvail().x, 10.0f), height = 190.0f * ui.scale;
  const int under = drawTrail(ui, {{low.x, low.y}, {low.x + width, low.y + height}}, state);
  ImGui::Dummy({width, height});
  ui.marks.last("plot");
  if (under >= 0) ImGui::SetTooltip("%s", inWords(state.points[static_cast<size_t>(under)]).c_str());
  ImGui::PushTextWrapPos(0.0f);
  ImGui::TextDisabled("%s", state.trailWords.c_str());
  ImGui::PopTextWrapPos();
  ui.marks.last("trail-words");
  if (ImGui::SmallButton("forget")) result.forgetTrail = true;
  ui.marks.last("forget");
  tooltip("takes the points of earlier settings away");
  ImGui::SameLine();
  if (ImGui::SmallButton("copy")) result.copyTrail = true;
  ui.marks.last("copy");
  tooltip("all points as CSV, to the clipboard");
  ImGui::SameLine();
  if (ImGui::SmallButton("save…")) result.saveTrail = true;
  ui.marks.last("save");
}

}  // namespace

ComparePanelResult drawComparePanel(Ui& ui, const ComparePanelModel& model) {
  ComparePanelResult result;
  const Marks::Scope scope(ui.marks, "compare");
  ImGui::PushItemWidth(-85.0f * ui.scale);
  chooseReference(ui, model, result);
  reference(ui, model, result);
  if (model.state->compares) {
    ImGui::Separator();
    figures(ui, *model.state, result);
    ImGui::Separator();
    trail(ui, *model.state, result);
  }
  ImGui::PopItemWidth();
  return result;
}

}  // namespace weir::view
