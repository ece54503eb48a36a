#include "view/panels/picture_panel.h"

#include "view/ui/style.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace weir::view {
namespace {

void choosePort(Ui& ui, const SideModel& side, PicturePanelResult& result) {
  if (ImGui::BeginCombo("port", side.port.c_str(), ImGuiComboFlags_HeightLarge)) {
    for (const std::string& port : side.ports) {
      if (ImGui::Selectable(port.c_str(), port == side.port)) result.port = port;
      ui.marks.last("port/" + port);
    }
    ImGui::EndCombo();
  }
  ui.marks.last("port");
  if (!side.problem.empty()) {
    ImGui::PushStyleColor(ImGuiCol_Text, palette().bad);
    ImGui::TextWrapped("%s", side.problem.c_str());
    ImGui::PopStyleColor();
  } else {
    ImGui::TextDisabled("%s", side.what.c_str());
  }
}

void chooseChannel(Ui& ui, const SideModel& side, PicturePanelResult& result) {
  const std::vector<Channel>& channels = *side.channels;
  const Channel& shown = channels[side.channel];
  if (ImGui::BeginCombo("channel", shown.name.c_str(), ImGuiComboFlags_HeightLarge)) {
    for (size_t i = 0; i < channels.size(); ++i) {
      ImGui::PushID(static_cast<int>(i));
      if (ImGui::Selectable(channels[i].name.c_str(), i == side.channel)) result.channel = i;
      ImGui::PopID();
      ui.marks.last("channel/" + channels[i].name);
      if (ImGui::IsItemHovered() && !channels[i].doc.empty()) ImGui::SetTooltip("%s", channels[i].doc.c_str());
    }
    ImGui::EndCombo();
  }
  ui.marks.last("channel");
  if (!shown.doc.empty()) {
    ImGui::PushStyleColor(ImGuiCol_Text, palette().faint);
    ImGui::TextWrapped("%s", shown.doc.c_str());
    ImGui::PopStyleColor();
  }
}

void turnMode(Ui& ui, const SideModel& side, PicturePanelResult& result) {
  const Channel& channel = (*side.channels)[side.channel];
  PictureMode mode = side.mode;
  bool changed = false;
  const bool numbers =
      channel.shows == Shows::Number || channel.shows == Shows::Color || channel.shows == Shows::Direction;
  if (channel.exposed) {
    changed |= ImGui::SliderFloat("exposure", &mode.exposure, -10.0f, 10.0f, "%.2f EV");
    ui.marks.last("exposure");
    mode.exposure = std::clamp(mode.exposure, -kMostExposure, kMostExposure);
  }
  if (numbers) {
    const float span = std::max(std::abs(mode.high - mode.low), 1e-30f);
    const char* format = "%.4g";
    ImGui::SetNextItemWidth(95.0f * ui.scale);
    changed |= ImGui::DragFloat("##low", &mode.low, span * 0.005f, 0.0f, 0.0f, format);
    ui.marks.last("low");
    ImGui::SameLine();
    ImGui::SetNextItemWidth(95.0f * ui.scale);
    changed |= ImGui::DragFloat("range", &mode.high, span * 0.005f, 0.0f, 0.0f, format);
    ui.marks.last("high");
    if (!std::isfinite(mode.low)) mode.low = 0.0f;
    if (!std::isfinite(mode.high)) mode.high = 1.0f;
    if (ImGui::Button("auto")) result.measure = true;
    ui.marks.last("auto-range");
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("1st to 99th percentile of what is shown");
    ImGui::SameLine();
    if (ImGui::Button("reset")) result.resetMode = true;
    ui.marks.last("reset");
    ImGui::SameLine();
    changed |= ImGui::Checkbox("log", &mode.logarithmic);
    ui.marks.last("log");
    ImGui::SameLine();
    changed |= ImGui::Checkbox("mark", &mode.markRange);
    ui.marks.last("mark");
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("blue below the range, red above it");
    if (channel.shows != Shows::Direction) {
      changed |= ImGui::Checkbox("false colour", &mode.falseColor);
      ui.marks.last("false-colour");
    }
    ImGui::SameLine();
    constexpr std::array<const char*, 3> kSigns = {"v", "|v|", "- red, + green"};
    int sign = static_cast<int>(mode.sign);
    ImGui::SetNextItemWidth(80.0f * ui.scale);
    if (ImGui::Combo("sign", &sign, kSigns.data(), static_cast<int>(kSigns.size()))) {
      mode.sign = static_cast<Sign>(sign);
      changed = true;
    }
    ui.marks.last("sign");
  }
  if (side.elements > 1) {
    int element = static_cast<int>(mode.element);
    if (ImGui::SliderInt("element", &element, 0, static_cast<int>(side.elements) - 1)) {
      mode.element = static_cast<uint32_t>(std::clamp(element, 0, static_cast<int>(side.elements) - 1));
      changed = true;
    }
    ui.marks.last("element");
  }
  if (side.measured && side.measured->channel == channel.name) {
    const Measurement& m = *side.measured;
    ImGui::TextDisabled("%.5g … %.5g%s%s", static_cast<double>(m.low), static_cast<double>(m.high),
                        channel.unit.empty() ? "" : " ", channel.unit.c_str());
    if (m.others > 0)
      ImGui::TextColored(ImColor(palette().bad), "%llu not finite", static_cast<unsigned long long>(m.others));
  }
  if (changed) result.mode = mode;
}

void placement(Ui& ui, const PicturePanelModel& model, PicturePanelResult& result) {
  ImGui::Text("%u x %u at %.4g", model.size.x, model.size.y, static_cast<double>(model.zoom));
  ui.marks.last("size");
  ImGui::SameLine();
  if (ImGui::SmallButton("fit")) result.zoom = 0.0f;
  ui.marks.last("fit");
  for (const auto& [label, zoom] :
       std::array<std::pair<const char*, float>, 3>{{{"1:1", 1.0f}, {"4:1", 4.0f}, {"16:1", 16.0f}}}) {
    ImGui::SameLine();
    if (ImGui::SmallButton(label)) result.zoom = zoom;
    ui.marks.last(label);
  }
  float scale = model.renderScale;
  ImGui::BeginDisabled(model.fixedSize.x > 0);
  if (ImGui::SliderFloat("scale", &scale, 0.1f, 2.0f, "%.2f")) result.renderScale = std::clamp(scale, 0.1f, 2.0f);
  ImGui::EndDisabled();
  ui.marks.last("scale");
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("rendered pixels for each of the window's, each way");
  bool fixed = model.fixedSize.x > 0;
  if (ImGui::Checkbox("fixed size", &fixed)) result.fixedSize = fixed ? model.size : glm::uvec2(0);
  ui.marks.last("fixed");
  if (model.fixedSize.x > 0) {
    glm::ivec2 size(model.fixedSize);
    ImGui::InputInt2("pixels", &size.x, ImGuiInputTextFlags_EnterReturnsTrue);
    if (ImGui::IsItemDeactivatedAfterEdit())
      result.fixedSize = glm::uvec2(glm::clamp(size, glm::ivec2(1), glm::ivec2(16384)));
    ui.marks.last("pixels");
  }
  if (model.pacings.size() > 1 &&
      ImGui::BeginCombo("display", model.pacings[static_cast<size_t>(model.pacing)].c_str())) {
    for (size_t i = 0; i < model.pacings.size(); ++i) {
      if (ImGui::Selectable(model.pacings[i].c_str(), static_cast<int>(i) == model.pacing))
        result.pacing = static_cast<int>(i);
      ui.marks.last("display/" + model.pacings[i]);
    }
    ImGui::EndCombo();
  }
  ui.marks.last("display");
}

void words(Ui& ui, const PicturePanelModel& model) {
  if (!model.pixel) {
    ImGui::TextDisabled("nothing under the mouse");
    return;
  }
  ImGui::Text("pixel %u, %u%s", model.pixel->x, model.pixel->y, model.pinned ? " (pinned: Alt+click)" : "");
  ui.marks.last("pixel");
  if (model.words == nullptr || model.words->empty()) return;
  if (!ImGui::BeginTable("probe", 2, ImGuiTableFlags_SizingFixedFit)) return;
  ImGui::TableSetupColumn("what", ImGuiTableColumnFlags_WidthFixed);
  ImGui::TableSetupColumn("is", ImGuiTableColumnFlags_WidthStretch);
  for (const Row& row : *model.words) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextDisabled("%s", row.label.c_str());
    ImGui::TableNextColumn();
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextUnformatted(row.text.c_str());
    ImGui::PopTextWrapPos();
    ui.marks.last("probe/" + row.label);
  }
  ImGui::EndTable();
}

}  // namespace

PicturePanelResult drawPicturePanel(Ui& ui, const PicturePanelModel& model) {
  PicturePanelResult result;
  const Marks::Scope scope(ui.marks, "shown");
  ImGui::PushItemWidth(-85.0f * ui.scale);
  choosePort(ui, model.a, result);
  if (model.a.channels != nullptr && !model.a.channels->empty()) {
    chooseChannel(ui, model.a, result);
    turnMode(ui, model.a, result);
  }
  ImGui::Separator();
  placement(ui, model, result);
  ImGui::Separator();
  words(ui, model);
  ImGui::PopItemWidth();
  return result;
}

}  // namespace weir::view
