#include "view/panels/graph_panel.h"

#include "view/panels/graph_edges.h"
#include "view/panels/hints.h"
#include "view/panels/pass_box.h"
#include "view/ui/style.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>

namespace weir::view {
namespace {

bool button(Ui& ui, const char* text, const char* name, bool possible, const std::string& words) {
  ImGui::BeginDisabled(!possible);
  const bool clicked = ImGui::Button(text);
  ImGui::EndDisabled();
  ui.marks.last(name);
  hint(words);
  return clicked;
}

void drawOtherFile(Ui& ui, GraphPanelState& state, GraphRequests& requests) {
  ImGui::SetNextItemWidth(-ImGui::GetFontSize() * 4.0f);
  bool done = ImGui::InputText("##path", &state.otherFile, ImGuiInputTextFlags_EnterReturnsTrue);
  ui.marks.last("save_path");
  ImGui::SameLine();
  done |= button(ui, "OK", "save_ok", !state.otherFile.empty(), "write it there");
  if (!done || state.otherFile.empty()) return;
  requests.saveAs = state.otherFile;
  state.namesFile = false;
}

void drawHead(Ui& ui, const GraphModel& model, GraphPanelState& state, GraphRequests& requests) {
  ImGui::TextUnformatted((model.name + (model.changed ? " *" : "")).c_str());
  hint(model.file + (model.changed ? "\nnot saved" : ""));
  requests.save = button(ui, "Save", "save", model.changed, "write " + model.file);
  ImGui::SameLine();
  if (button(ui, "Save as", "save_as", true, "write another file, and go on with that")) {
    state.namesFile = !state.namesFile;
    state.otherFile = model.file;
  }
  ImGui::SameLine();
  if (button(ui, "Undo", "undo", !model.undoes.empty(), model.undoes)) requests.edits.emplace_back(Undo{});
  ImGui::SameLine();
  if (button(ui, "Redo", "redo", !model.redoes.empty(), model.redoes)) requests.edits.emplace_back(Redo{});
  if (state.namesFile) drawOtherFile(ui, state, requests);
}

/// What is wrong, above everything; a click goes to the pass.
void drawProblems(Ui& ui, const GraphModel& model, GraphPanelState& state) {
  constexpr size_t kMost = 4;
  const Marks::Scope scope(ui.marks, "problem");
  ImGui::PushStyleColor(ImGuiCol_Text, palette().bad);
  for (size_t i = 0; i < std::min(model.problems.size(), kMost); ++i) {
    const Problem& problem = model.problems[i];
    wrapped(problem.text, palette().bad);
    ui.marks.last(std::to_string(i));
    if (ImGui::IsItemClicked() && !problem.pass.empty()) state.selected = state.revealed = problem.pass;
  }
  ImGui::PopStyleColor();
  if (model.problems.size() > kMost) ImGui::TextDisabled("… %zu more, at their passes", model.problems.size() - kMost);
}

void drawPasses(Ui& ui, const GraphModel& model, GraphPanelState& state, GraphRequests& requests) {
  const float left = 34.0f * ui.scale, right = 20.0f * ui.scale;
  const float width = std::max(ImGui::GetContentRegionAvail().x - left - right, ImGui::GetFontSize() * 10.0f);
  const PassFrame frame{ui, model, state, requests};
  std::vector<PassAnchors> anchors;
  anchors.reserve(model.passes.size());
  for (size_t i = 0; i < model.passes.size(); ++i) {
    ImGui::SetCursorPosX(left);
    anchors.push_back(drawPassBox(frame, i, width));
  }
  drawEdges(model, anchors, state.hovered, left, right);
  state.hovered.clear();
  if (!ImGui::IsWindowHovered(ImGuiHoveredFlags_AllowWhenBlockedByActiveItem)) return;
  const ImVec2 mouse = ImGui::GetMousePos();
  for (size_t i = 0; i < anchors.size(); ++i)
    if (anchors[i].box.contains({mouse.x, mouse.y})) state.hovered = model.passes[i].name;
}

}  // namespace

GraphRequests drawGraphPanel(Ui& ui, const GraphModel& model, GraphPanelState& state) {
  GraphRequests requests;
  const Marks::Scope scope(ui.marks, "graph");
  drawHead(ui, model, state, requests);
  drawProblems(ui, model, state);
  ImGui::Separator();
  if (ImGui::BeginChild("passes")) drawPasses(ui, model, state, requests);
  ImGui::EndChild();
  return requests;
}

}  // namespace weir::view
