#include "view/panels/scene_panel.h"

#include "view/ui/style.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace weir::view {
namespace {

const char* kindName(scene::LightKind kind) {
  switch (kind) {
    case scene::LightKind::Spot:
      return "spot";
    case scene::LightKind::Directional:
      return "directional";
    default:
      return "point";
  }
}

std::string labelOf(const scene::PunctualLight& light, size_t index) {
  return light.name.empty() ? std::string(kindName(light.kind)) + " " + std::to_string(index) : light.name;
}

bool header(Ui& ui, const char* name, bool open) {
  const bool is = ImGui::CollapsingHeader(name, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
  ui.marks.last(name);
  return is;
}

void facts(const SceneModel& scene) {
  if (!ImGui::BeginTable("facts", 2, ImGuiTableFlags_SizingFixedFit)) return;
  for (const auto& [label, value] : scene.facts) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextDisabled("%s", label.c_str());
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(value.c_str());
  }
  ImGui::EndTable();
  if (!scene.warnings.empty()) {
    ImGui::PushStyleColor(ImGuiCol_Text, palette().warning);
    for (const std::string& warning : scene.warnings) ImGui::TextWrapped("%s", warning.c_str());
    ImGui::PopStyleColor();
  }
}

void cameras(Ui& ui, const ScenePanelModel& model, Requests& requests) {
  if (ImGui::Button("frame all (F)")) requests.push_back(ChooseCamera{-1});
  ui.marks.last("frame-all");
  for (size_t i = 0; i < model.scene->cameras.size(); ++i) {
    const std::string& name = model.scene->cameras[i];
    ImGui::PushID(static_cast<int>(i));
    if (ImGui::Selectable(name.c_str(), name == model.camera)) requests.push_back(ChooseCamera{static_cast<int>(i)});
    ImGui::PopID();
    ui.marks.last(name);
  }
  float degrees = model.fieldOfView;
  if (ImGui::SliderFloat("field of view", &degrees, 5.0f, 150.0f, "%.1f deg"))
    requests.push_back(SetFieldOfView{degrees});
  ui.marks.last("field-of-view");
  float speed = model.speed;
  if (ImGui::DragFloat("speed", &speed, 0.01f * speed, 1e-6f, 1e6f, "%.3g m/s", ImGuiSliderFlags_Logarithmic))
    requests.push_back(SetSpeed{speed});
  ui.marks.last("speed");
  ImGui::PushTextWrapPos(0.0f);
  ImGui::TextDisabled("%s", model.camera.c_str());
  ImGui::PopTextWrapPos();
}

/// The chosen light's place and colour. Intensity is told apart from colour, whose largest part is 1.
void editLight(Ui& ui, const scene::PunctualLight& light, size_t index, bool canMove, Requests& requests) {
  const Marks::Scope scope(ui.marks, "light");
  const float strength = std::max({light.intensity.x, light.intensity.y, light.intensity.z});
  if (!(strength > 0.0f)) {
    ImGui::TextDisabled("dark: it is in no table");
    return;
  }
  scene::PunctualLight to = light;
  bool changed = false;
  glm::vec3 colour = light.intensity / strength;
  if (ImGui::ColorEdit3("colour", &colour.x, ImGuiColorEditFlags_Float)) {
    // A light never goes out altogether: it would leave the table.
    const float largest = std::max({colour.x, colour.y, colour.z});
    to.intensity = largest > 0.0f ? colour / largest * strength : glm::vec3(strength);
    changed = true;
  }
  ui.marks.last("colour");
  float intensity = strength;
  const char* unit = light.kind == scene::LightKind::Directional ? "%.4g lx" : "%.4g cd";
  if (ImGui::DragFloat("intensity", &intensity, 0.01f * strength, 1e-12f, 1e12f, unit, ImGuiSliderFlags_Logarithmic)) {
    to.intensity = light.intensity * (std::max(intensity, 1e-12f) / strength);
    changed = true;
  }
  ui.marks.last("intensity");
  ImGui::BeginDisabled(!canMove);
  if (light.kind != scene::LightKind::Directional) {
    const float step = 0.002f * std::max(glm::length(light.position), 1.0f);
    changed |= ImGui::DragFloat3("position", &to.position.x, step, 0.0f, 0.0f, "%.4g m");
    ui.marks.last("position");
  }
  if (light.kind != scene::LightKind::Point) {
    glm::vec3 direction = to.direction;
    if (ImGui::DragFloat3("direction", &direction.x, 0.01f, -1.0f, 1.0f, "%.3f") && glm::length(direction) > 0.0f) {
      to.direction = glm::normalize(direction);
      changed = true;
    }
    ui.marks.last("direction");
  }
  ImGui::EndDisabled();
  if (!canMove && ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) ImGui::SetTooltip("a clip moves it");
  if (changed) requests.push_back(SetLight{index, to});
}

void lights(Ui& ui, const ScenePanelModel& model, ScenePanelState& state, Requests& requests) {
  const std::vector<scene::PunctualLight>& all = *model.lights;
  if (!all.empty()) {
    ImGui::InputTextWithHint("##filter", "name", &state.filter);
    ui.marks.last("filter");
    state.light = std::min(state.light, all.size() - 1);
    ImGui::BeginChild("list", {0.0f, 110.0f * ui.scale}, true);
    const auto row = [&](size_t i) {
      ImGui::PushID(static_cast<int>(i));
      const glm::vec3 c =
          all[i].intensity / std::max({all[i].intensity.x, all[i].intensity.y, all[i].intensity.z, 1e-30f});
      ImGui::ColorButton("##colour", {c.x, c.y, c.z, 1.0f}, ImGuiColorEditFlags_NoTooltip,
                         {ImGui::GetTextLineHeight(), ImGui::GetTextLineHeight()});
      ImGui::SameLine();
      if (ImGui::Selectable(labelOf(all[i], i).c_str(), i == state.light)) state.light = i;
      ui.marks.last(labelOf(all[i], i));
      ImGui::PopID();
    };
    if (state.filter.empty()) {
      // Two million names are not drawn, only those in view.
      ImGuiListClipper clipper;
      clipper.Begin(static_cast<int>(std::min<size_t>(all.size(), 10000000)));
      while (clipper.Step())
        for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) row(static_cast<size_t>(i));
    } else {
      int shown = 0;
      for (size_t i = 0; i < all.size() && shown < 200 && i < 200000; ++i) {
        if (labelOf(all[i], i).find(state.filter) == std::string::npos) continue;
        row(i);
        ++shown;
      }
    }
    ImGui::EndChild();
    editLight(ui, all[state.light], state.light, (*model.canMove)[state.light], requests);
  }
  ImGui::SetNextItemWidth(90.0f * ui.scale);
  ImGui::InputInt("##count", &state.generate, 0);
  ui.marks.last("count");
  state.generate = std::clamp(state.generate, 1, 2000000);
  ImGui::SameLine();
  ImGui::SetNextItemWidth(50.0f * ui.scale);
  ImGui::InputInt("seed", &state.seed, 0);
  state.seed = std::max(state.seed, 0);
  ImGui::SameLine();
  if (ImGui::Button("points"))
    requests.push_back(SetSceneLights{static_cast<uint32_t>(state.generate), static_cast<uint32_t>(state.seed)});
  ui.marks.last("generate");
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("Loads the scene with so many point lights in place of its own");
  if (model.generated > 0) {
    ImGui::SameLine();
    if (ImGui::Button("own")) requests.push_back(SetSceneLights{0, 1});
    ui.marks.last("own");
  }
}

void time(Ui& ui, const ScenePanelModel& model, Requests& requests) {
  const std::vector<std::string>& clips = model.scene->clips;
  const char* shown = model.clip < 0 ? "at rest" : clips[static_cast<size_t>(model.clip)].c_str();
  if (ImGui::BeginCombo("clip", shown)) {
    if (ImGui::Selectable("at rest", model.clip < 0)) requests.push_back(ChooseClip{-1});
    ui.marks.last("clip/rest");
    for (size_t i = 0; i < clips.size(); ++i) {
      ImGui::PushID(static_cast<int>(i));
      if (ImGui::Selectable(clips[i].c_str(), static_cast<int>(i) == model.clip))
        requests.push_back(ChooseClip{static_cast<int>(i)});
      ui.marks.last("clip/" + clips[i]);
      ImGui::PopID();
    }
    ImGui::EndCombo();
  }
  ui.marks.last("clip");
  if (model.clip < 0) return;
  bool plays = model.plays;
  if (ImGui::Checkbox("##plays", &plays)) requests.push_back(SetPlays{plays});
  ui.marks.last("plays");
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("whether the clip goes on");
  ImGui::SameLine();
  auto seconds = static_cast<float>(model.duration > 0.0 ? std::fmod(model.seconds, model.duration) : model.seconds);
  if (ImGui::SliderFloat("time", &seconds, 0.0f, static_cast<float>(model.duration), "%.3f s"))
    requests.push_back(SetSeconds{static_cast<double>(seconds)});
  ui.marks.last("time");
}

}  // namespace

Requests drawScenePanel(Ui& ui, const ScenePanelModel& model, ScenePanelState& state) {
  Requests requests;
  const Marks::Scope scope(ui.marks, "scene");
  if (model.loading) ImGui::TextColored(ImColor(palette().accent), "loading…");
  if (header(ui, "Contents", true)) facts(*model.scene);
  if (header(ui, "Camera", true)) cameras(ui, model, requests);
  if (header(ui, "Lights", true)) lights(ui, model, state, requests);
  if (!model.scene->clips.empty() && header(ui, "Animation", true)) time(ui, model, requests);
  return requests;
}

}  // namespace weir::view
