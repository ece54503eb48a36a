#include "view/panels/overlays.h"

#include "view/ui/style.h"

#include <imgui.h>

#include <array>
#include <utility>

namespace weir::view {

Requests drawMessages(Ui& ui, const Rectangle& picture, const std::vector<Message>& messages) {
  Requests requests;
  if (messages.empty()) return requests;
  const Marks::Scope scope(ui.marks, "messages");
  ImGui::SetNextWindowPos({picture.low.x + 8.0f * ui.scale, picture.low.y + 34.0f * ui.scale});
  const float width = std::max(picture.size().x - 16.0f * ui.scale, 200.0f);
  ImGui::SetNextWindowSizeConstraints({width, 0.0f}, {width, std::max(picture.size().y * 0.6f, 60.0f)});
  ImGui::SetNextWindowBgAlpha(0.88f);
  constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                                      ImGuiWindowFlags_NoMove | ImGuiWindowFlags_AlwaysAutoResize |
                                      ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav;
  if (ImGui::Begin("messages", nullptr, kFlags)) {
    for (const Message& message : messages) {
      ImGui::PushID(static_cast<int>(message.number));
      const uint32_t colour = message.severity == Severity::Error     ? palette().bad
                              : message.severity == Severity::Warning ? palette().warning
                                                                      : palette().good;
      if (ImGui::SmallButton("x")) requests.push_back(Dismiss{message.number});
      ui.marks.last(message.topic + "/dismiss");
      ImGui::SameLine();
      ImGui::PushStyleColor(ImGuiCol_Text, colour);
      ImGui::TextUnformatted(message.topic.c_str());
      ImGui::PopStyleColor();
      ImGui::SameLine();
      if (ImGui::SmallButton("copy")) ImGui::SetClipboardText(message.text.c_str());
      ImGui::PushTextWrapPos(0.0f);
      ImGui::TextUnformatted(message.text.c_str());
      ImGui::PopTextWrapPos();
      ui.marks.last(message.topic);
      ImGui::PopID();
    }
  }
  ImGui::End();
  return requests;
}

void drawHelp(Ui& ui, glm::vec2 window, bool& open) {
  if (!open) return;
  const Marks::Scope scope(ui.marks, "help");
  ImGui::SetNextWindowPos({window.x * 0.5f, window.y * 0.5f}, ImGuiCond_Appearing, {0.5f, 0.5f});
  if (ImGui::Begin("Help", &open, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse)) {
    constexpr std::array<std::pair<const char*, const char*>, 27> kRows = {
        {{"Mouse on the picture", nullptr},
         {"left drag", "turn round what is looked at"},
         {"right drag", "look around; with W A S D, Q E: fly (Shift: faster)"},
         {"middle drag, Shift + left drag", "move sideways"},
         {"wheel", "nearer, farther; with Ctrl: zoom into the picture"},
         {"hover", "what the shown port holds there, in words (Picture panel)"},
         {"Keys", nullptr},
         {"Space", "pause, go on"},
         {".", "one frame"},
         {"R", "restart without history"},
         {"F", "frame the whole scene"},
         {"1 … 9", "the scene's cameras"},
         {"C", "split: left A, right B; drag the line"},
         {"Tab", "the picture alone"},
         {"F1", "this help"},
         {"F2, F3, F4", "graph, side and time panels"},
         {"F5", "read shaders, plugins and the graph's file again"},
         {"Ctrl+O, Ctrl+Shift+O", "open a graph, a scene"},
         {"Ctrl+S, Ctrl+Shift+S", "save the graph, under another name"},
         {"Ctrl+Z, Ctrl+Shift+Z", "undo, redo an edit of the graph"},
         {"Ctrl+P", "picture of the shown output into a file"},
         {"Ctrl+C", "copy the weir render command for this view"},
         {"Ctrl+Q", "quit"},
         {"Widgets", nullptr},
         {"Ctrl+click on a slider", "type a number"},
         {"dot beside a name", "changed; click it to reset"},
         {"files on the window", "a scene (.gltf, .glb), a graph (.json), a picture to compare with (.exr)"}}};
    if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit)) {
      for (const auto& [key, what] : kRows) {
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        if (what == nullptr) {
          ImGui::TextColored(ImColor(palette().accent), "%s", key);
          continue;
        }
        ImGui::TextUnformatted(key);
        ImGui::TableNextColumn();
        ImGui::TextDisabled("%s", what);
      }
      ImGui::EndTable();
    }
    if (ImGui::Button("close")) open = false;
    ui.marks.last("close");
  }
  ImGui::End();
}

CloseAnswer drawCloseQuestion(Ui& ui, glm::vec2 window, bool& open) {
  if (!open) return CloseAnswer::None;
  const Marks::Scope scope(ui.marks, "close");
  CloseAnswer answer = CloseAnswer::None;
  ImGui::SetNextWindowPos({window.x * 0.5f, window.y * 0.5f}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowFocus();
  if (ImGui::Begin("Not saved", nullptr,
                   ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove)) {
    ImGui::TextUnformatted("The graph has changes that are not saved.");
    const auto button = [&](const char* label, const char* name, CloseAnswer meaning) {
      if (ImGui::Button(label)) answer = meaning;
      ui.marks.last(name);
      ImGui::SameLine();
    };
    button("Save and quit", "save", CloseAnswer::Save);
    button("Discard them", "discard", CloseAnswer::Discard);
    button("Stay", "stay", CloseAnswer::Stay);
  }
  ImGui::End();
  if (answer != CloseAnswer::None) open = false;
  return answer;
}

}  // namespace weir::view
