#include "view/panels/pass_box.h"

#include "view/panels/hints.h"
#include "view/panels/pass_details.h"
#include "view/ui/style.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

namespace weir::view {
namespace {

/// "plugin.Pass" → "Pass".
const char* shortType(const std::string& type) {
  const size_t dot = type.find('.');
  return type.c_str() + (dot == std::string::npos ? 0 : dot + 1);
}

class Box {
 public:
  Box(const PassFrame& frame, size_t index, float width)
      : f_(frame), pass_(frame.model.passes[index]), index_(index), width_(width), list_(*ImGui::GetWindowDrawList()) {}

  PassAnchors draw() {
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const float padding = 4.0f * f_.ui.scale, left = ImGui::GetCursorPosX();
    const bool open = f_.state.selected == pass_.name;
    ImGui::PushID(pass_.name.c_str());
    list_.ChannelsSplit(2);
    list_.ChannelsSetCurrent(1);
    ImGui::SetCursorScreenPos({corner.x + padding, corner.y + padding});
    ImGui::BeginGroup();
    const float inner = width_ - 2.0f * padding;
    // Widgets end at the box, wherever the window ends.
    right_ = ImGui::GetCursorPosX() + inner;
    title(inner);
    const Marks::Scope scope(f_.ui.marks, pass_.name);
    anchors_.inputs.assign(pass_.inputs.size(), 0.0f);
    anchors_.outputs.assign(pass_.outputs.size(), 0.0f);
    const float titleEnd = ImGui::GetCursorScreenPos().y;
    outputs();
    const float portsEnd = std::max(ImGui::GetItemRectMax().y, titleEnd);
    if (open) drawPassDetails(f_, pass_, inner);
    ImGui::EndGroup();
    anchors_.box = {{corner.x, corner.y}, {corner.x + width_, ImGui::GetItemRectMax().y + padding}};
    frame(open);
    list_.ChannelsMerge();
    inputs(corner.y + padding, portsEnd - 2.0f * padding);
    ImGui::SetCursorScreenPos({corner.x, anchors_.box.high.y});
    ImGui::SetCursorPosX(left);
    ImGui::Dummy({width_, ImGui::GetStyle().ItemSpacing.y * 0.5f});
    ImGui::PopID();
    if (f_.state.revealed == pass_.name) {
      ImGui::SetScrollHereY(0.3f);
      f_.state.revealed.clear();
    }
    return std::move(anchors_);
  }

 private:
  void frame(bool open) {
    const Rectangle& box = anchors_.box;
    const ImVec2 low{box.low.x, box.low.y}, high{box.high.x, box.high.y};
    visible_ = ImGui::IsRectVisible(low, high);
    if (!visible_) return;
    const float rounding = 4.0f * f_.ui.scale;
    list_.ChannelsSetCurrent(0);
    const uint32_t fill = ImGui::GetColorU32(ImGuiCol_FrameBg, open ? 0.75f : 0.45f);
    list_.AddRectFilled(low, high, fill, rounding);
    const bool wrong = !pass_.problems.empty() || hasProblems();
    if (wrong || open) list_.AddRect(low, high, wrong ? palette().bad : palette().accent, rounding);
    const ImVec2 stripe{low.x + 3.0f * f_.ui.scale, high.y};
    const uint32_t color = seriesColor(static_cast<unsigned>(index_));
    if (pass_.runs) list_.AddRectFilled(low, stripe, color, rounding, ImDrawFlags_RoundCornersLeft);
  }

  bool hasProblems() const {
    const auto some = [](const auto& items) {
      return std::any_of(items.begin(), items.end(), [](const auto& item) { return !item.problems.empty(); });
    };
    return some(pass_.params) || some(pass_.inputs);
  }

  void switchOn() {
    const Marks::Scope scope(f_.ui.marks, pass_.name);
    bool enabled = pass_.enabled;
    // What can't be left out can't be unticked; what is off can always be put on.
    const bool fixed = enabled && !pass_.mustRun.empty();
    ImGui::BeginDisabled(fixed);
    if (ImGui::Checkbox("##enabled", &enabled)) f_.requests.edits.emplace_back(SetEnabled{pass_.name, enabled});
    ImGui::EndDisabled();
    f_.ui.marks.last("enabled");
    if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled))
      hint(fixed ? "can't be disabled: " + pass_.mustRun : enabled ? "disable" : "enable");
  }

  void title(float inner) {
    const float begin = ImGui::GetCursorPosX();
    switchOn();
    ImGui::SameLine();
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float height = ImGui::GetFrameHeight(), width = begin + inner - ImGui::GetCursorPosX();
    if (ImGui::InvisibleButton("open", {std::max(width, 1.0f), height})) {
      const bool closes = f_.state.selected == pass_.name;
      f_.state.selected = closes ? std::string() : pass_.name;
    }
    f_.ui.marks.last(pass_.name);
    const bool hovered = ImGui::IsItemHovered();
    if (hovered) hint(titleHint());
    if (!ImGui::IsItemVisible()) return;
    const float y = at.y + ImGui::GetStyle().FramePadding.y, right = at.x + width;
    const float end = time(right, y);
    const uint32_t text = ImGui::GetColorU32(pass_.runs ? ImGuiCol_Text : ImGuiCol_TextDisabled);
    list_.PushClipRect({at.x, at.y}, {end, at.y + height}, true);
    list_.AddText({at.x, y}, hovered ? palette().accent : text, pass_.name.c_str());
    const float after = at.x + ImGui::CalcTextSize(pass_.name.c_str()).x + ImGui::GetStyle().ItemSpacing.x;
    const uint32_t faint = ImGui::GetColorU32(ImGuiCol_TextDisabled, pass_.runs ? 1.0f : 0.7f);
    list_.AddText({after, y}, faint, shortType(pass_.type));
    list_.PopClipRect();
    if (pass_.changed > 0)
      list_.AddCircleFilled({end - 5.0f * f_.ui.scale, at.y + height * 0.5f}, 3.0f, palette().changed);
  }

  std::string titleHint() const {
    std::string text = pass_.type;
    if (!pass_.doc.empty()) text += "\n" + pass_.doc;
    if (!pass_.runs) text += "\ndoes not run: " + pass_.reason;
    if (pass_.changed > 0)
      text += fmt::format("\n{} parameter{} changed", pass_.changed, pass_.changed == 1 ? "" : "s");
    for (const std::string& problem : pass_.problems) text += "\n" + problem;
    return text;
  }

  /// Right-aligned milliseconds; where the room for the name ends.
  float time(float right, float y) {
    const auto found = f_.state.gpuMs.find(pass_.name);
    if (found == f_.state.gpuMs.end() || !pass_.runs) return right;
    const std::string text = fmt::format("{:.3g} ms", found->second);
    const float x = right - ImGui::CalcTextSize(text.c_str()).x;
    list_.AddText({x, y}, palette().faint, text.c_str());
    return x - ImGui::GetStyle().ItemSpacing.x;
  }

  /// Buttons with the outputs' names, in as many lines as they take.
  void outputs() {
    const Marks::Scope scope(f_.ui.marks, "port");
    const float begin = ImGui::GetCursorPosX(), spacing = ImGui::GetStyle().ItemSpacing.x * 0.5f;
    float x = begin;
    int inLine = 0;
    for (size_t i = 0; i < pass_.outputs.size(); ++i) {
      const PortModel& port = pass_.outputs[i];
      const float width = ImGui::CalcTextSize(port.name.c_str()).x + 2.0f * ImGui::GetStyle().FramePadding.x;
      if (i > 0 && x + width <= right_) {
        ImGui::SameLine(0.0f, spacing);
        ++inLine;
      } else {
        x = begin;
        inLine = 0;
      }
      x += width + spacing;
      const bool shown = f_.state.shown == port.port;
      if (shown) ImGui::PushStyleColor(ImGuiCol_Button, palette().accent);
      if (port.readers.empty()) ImGui::PushStyleColor(ImGuiCol_Text, palette().faint);
      if (ImGui::SmallButton(port.name.c_str())) f_.requests.show = port.port;
      if (port.readers.empty()) ImGui::PopStyleColor();
      if (shown) ImGui::PopStyleColor();
      f_.ui.marks.last(port.name);
      if (ImGui::IsItemHovered()) hint(portHint(port));
      // Those in one line leave the box a little apart.
      const float middle = (ImGui::GetItemRectMin().y + ImGui::GetItemRectMax().y) * 0.5f;
      anchors_.outputs[i] = middle + (static_cast<float>(inLine) - 1.0f) * 3.5f * f_.ui.scale;
    }
  }

  static std::string portHint(const PortModel& port) {
    std::string text = port.port + ": " + port.type;
    if (!port.doc.empty()) text += "\n" + port.doc;
    std::string readers;
    for (const std::string& reader : port.readers) readers += (readers.empty() ? "" : ", ") + reader;
    return text + "\n" + (readers.empty() ? "nobody reads it" : "read by " + readers) + "\nclick: show it";
  }

  /// Dots on the box's edge: on the left for this frame's values, on the right for last frame's.
  void inputs(float low, float high) {
    const Marks::Scope scope(f_.ui.marks, "input");
    const size_t count = std::max<size_t>(pass_.inputs.size(), 1);
    const float step = std::min((high - low) / static_cast<float>(count), 10.0f * f_.ui.scale);
    const float radius = std::min(3.0f * f_.ui.scale, step * 0.45f);
    for (size_t i = 0; i < pass_.inputs.size(); ++i) {
      const PortModel& port = pass_.inputs[i];
      const float y = low + step * (static_cast<float>(i) + 0.5f);
      const float x = port.previous ? anchors_.box.high.x : anchors_.box.low.x;
      anchors_.inputs[i] = y;
      const float reach = std::max(radius, step * 0.5f);
      ImGui::SetCursorScreenPos({x - 2.0f * reach, y - reach});
      ImGui::PushID(static_cast<int>(i));
      if (ImGui::InvisibleButton("input", {4.0f * reach, 2.0f * reach}) && !port.port.empty())
        f_.requests.show = port.port;
      f_.ui.marks.last(port.name);
      if (ImGui::IsItemHovered()) hint(inputHint(port));
      ImGui::PopID();
      if (!visible_) continue;
      const uint32_t color = !port.problems.empty() ? palette().bad : ImGui::GetColorU32(ImGuiCol_Text);
      if (port.port.empty())
        list_.AddCircle({x, y}, radius, palette().faint);
      else
        list_.AddCircleFilled({x, y}, radius, color);
    }
  }

  static std::string inputHint(const PortModel& port) {
    std::string text = port.name + ": " + port.type;
    if (!port.doc.empty()) text += "\n" + port.doc;
    if (port.port.empty()) return text + (port.required ? "\nnot connected, and must be" : "\nnot connected");
    text += "\nreads " + port.port + (port.previous ? " of the last frame" : "");
    for (const std::string& problem : port.problems) text += "\n" + problem;
    return text;
  }

  const PassFrame& f_;
  const PassModel& pass_;
  size_t index_;
  float width_, right_ = 0.0f;
  bool visible_ = true;
  ImDrawList& list_;
  PassAnchors anchors_;
};

}  // namespace

PassAnchors drawPassBox(const PassFrame& frame, size_t index, float width) {
  return Box(frame, index, width).draw();
}

}  // namespace weir::view
