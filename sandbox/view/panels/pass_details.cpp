#include "view/panels/pass_details.h"

#include "view/panels/hints.h"
#include "view/ui/style.h"

#include <fmt/format.h>
#include <imgui.h>

namespace weir::view {
namespace {

void drawChoice(const PassFrame& f, const PassModel& pass, const TypeChoice& choice) {
  ImGui::BeginDisabled(!choice.possible);
  if (ImGui::Selectable(choice.type.c_str(), choice.current) && !choice.current)
    f.requests.edits.emplace_back(SwapType{pass.name, choice.type});
  ImGui::EndDisabled();
  f.ui.marks.last(choice.type);
  std::string text = choice.doc;
  for (const std::string* more : {&choice.changes, &choice.reason})
    if (!more->empty()) text += (text.empty() ? "" : "\n") + *more;
  hint(text);
}

void drawType(const PassFrame& f, const PassModel& pass, float width) {
  ImGui::SetNextItemWidth(width);
  if (ImGui::BeginCombo("##type", pass.type.c_str())) {
    const Marks::Scope scope(f.ui.marks, "type");
    if (f.model.choicesOf == pass.name) {
      for (const TypeChoice& choice : f.model.choices) drawChoice(f, pass, choice);
    } else {
      f.requests.choicesOf = pass.name;
      ImGui::TextDisabled("…");
    }
    ImGui::EndCombo();
  }
  f.ui.marks.last("type");
  hint("what stands here; others that fit can take its place");
}

void drawSources(const PassFrame& f, const PassModel& pass, float width) {
  const Marks::Scope scope(f.ui.marks, "source");
  const float right = ImGui::GetCursorPosX() + width;
  for (const PortModel& input : pass.inputs) {
    const std::string source = input.port.empty() ? std::string("nothing") : input.port;
    const std::string text = fmt::format("{} ← {}{}", input.name, source, input.previous ? ", last frame" : "");
    ImGui::PushStyleColor(ImGuiCol_Text, input.previous ? palette().warning : palette().faint);
    if (ImGui::Selectable(text.c_str(), !input.port.empty() && f.state.shown == input.port, 0, {width, 0.0f}) &&
        !input.port.empty())
      f.requests.show = input.port;
    ImGui::PopStyleColor();
    f.ui.marks.last(input.name);
    if (ImGui::IsItemHovered()) hint(input.type + (input.doc.empty() ? "" : "\n" + input.doc));
    for (const std::string& problem : input.problems) wrapped(problem, palette().bad, right);
  }
}

}  // namespace

void drawPassDetails(const PassFrame& frame, const PassModel& pass, float width) {
  const float right = ImGui::GetCursorPosX() + width;
  drawType(frame, pass, width);
  if (!pass.doc.empty()) wrapped(pass.doc, palette().faint, right);
  if (!pass.runs) wrapped("does not run: " + pass.reason, palette().warning, right);
  for (const std::string& problem : pass.problems) wrapped(problem, palette().bad, right);
  drawSources(frame, pass, width);
  for (const ParamModel& param : pass.params) {
    const ParamRequest asked = drawParam(frame.ui, pass.name, param, width, frame.state.widget);
    const std::string& name = param.description.name;
    if (asked.value) frame.requests.edits.emplace_back(SetParam{pass.name, name, *asked.value, asked.continues});
    if (asked.reset) frame.requests.edits.emplace_back(ResetParam{pass.name, name});
  }
}

}  // namespace weir::view
