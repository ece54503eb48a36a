#include "view/panels/param_widgets.h"

#include "view/panels/hints.h"
#include "view/ui/style.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace weir::view {
namespace {

constexpr ImGuiSliderFlags kExact = ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_NoRoundToFormat;

/// "%.7g px", for numbers and their unit in one.
std::string formatOf(const ParamDescription& param) {
  std::string format = param.type == ParamType::Int ? "%d" : "%.7g";
  if (!param.unit.empty()) format += ' ';
  for (const char c : param.unit) format += c == '%' ? std::string("%%") : std::string(1, c);
  return format;
}

/// ImGui's sliders can't have more than half of a type's range.
template <typename T>
bool fitsSlider(const ParamDescription& param) {
  constexpr double kMost = static_cast<double>(std::numeric_limits<T>::max()) / 2;
  return param.low && param.high && *param.low >= -kMost && *param.high <= kMost && *param.low < *param.high;
}

template <typename T>
T within(double bound) {
  constexpr double kMost = static_cast<double>(std::numeric_limits<T>::max());
  return static_cast<T>(std::clamp(bound, -kMost, kMost));
}

template <typename T>
bool editNumber(T& value, const ParamDescription& param) {
  constexpr ImGuiDataType kType = std::is_same_v<T, float> ? ImGuiDataType_Float : ImGuiDataType_S32;
  constexpr T kMost = std::numeric_limits<T>::max();
  const T low = param.low ? within<T>(*param.low) : -kMost, high = param.high ? within<T>(*param.high) : kMost;
  const std::string format = formatOf(param);
  bool edited = false;
  if (fitsSlider<T>(param)) {
    const ImGuiSliderFlags by = isLogarithmic(param) ? ImGuiSliderFlags_Logarithmic : ImGuiSliderFlags_None;
    edited = ImGui::SliderScalar("##value", kType, &value, &low, &high, format.c_str(), kExact | by);
    if (ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) ImGui::SetKeyboardFocusHere(-1);
  } else {
    constexpr float kShareOfPixel = 0.005f;
    const float speed = std::max(std::abs(static_cast<float>(value)), 1.0f) * kShareOfPixel;
    edited = ImGui::DragScalar("##value", kType, &value, speed, &low, &high, format.c_str(), kExact);
  }
  if constexpr (std::is_same_v<T, float>)
    if (edited && ImGui::IsMouseDown(ImGuiMouseButton_Left)) value = rounded(value, param);
  return edited;
}

bool editChoice(Ui& ui, std::string& value, const ParamDescription& param) {
  bool edited = false;
  if (!ImGui::BeginCombo("##value", value.c_str())) return false;
  const Marks::Scope scope(ui.marks, param.name);
  for (const std::string& choice : param.choices) {
    if (ImGui::Selectable(choice.c_str(), choice == value)) {
      edited = choice != value;
      value = choice;
    }
    ui.marks.last(choice);
  }
  ImGui::EndCombo();
  return edited;
}

void drawName(Ui& ui, const ParamModel& param) {
  const float height = ImGui::GetFrameHeight(), dot = 3.0f * ui.scale;
  const ImVec2 at = ImGui::GetCursorScreenPos();
  if (param.changed)
    ImGui::GetWindowDrawList()->AddCircleFilled({at.x + dot, at.y + height * 0.5f}, dot, palette().changed);
  ImGui::SetCursorPosX(ImGui::GetCursorPosX() + 3.5f * dot);
  ImGui::AlignTextToFramePadding();
  if (!param.problems.empty()) ImGui::PushStyleColor(ImGuiCol_Text, palette().bad);
  ImGui::TextUnformatted(param.description.name.c_str());
  if (!param.problems.empty()) ImGui::PopStyleColor();
  hint(param.tooltip);
}

/// Whether the value was edited; ImGui's last item is the widget.
bool editValue(Ui& ui, ParamValue& value, const ParamDescription& param) {
  switch (param.type) {
    case ParamType::Bool:
      return ImGui::Checkbox("##value", &std::get<bool>(value));
    case ParamType::Int:
      return editNumber(std::get<int32_t>(value), param);
    case ParamType::Float:
      return editNumber(std::get<float>(value), param);
    case ParamType::Enum:
      return editChoice(ui, std::get<std::string>(value), param);
    case ParamType::String:
      return ImGui::InputText("##value", &std::get<std::string>(value));
  }
  return false;
}

/// What of the widget's life is to be asked for.
ParamRequest follow(bool edited, const std::string& key, const ParamModel& param, const ParamValue& value,
                    ParamWidgetState& state) {
  ParamRequest request;
  const ParamDescription& description = param.description;
  if (description.type == ParamType::Bool || description.type == ParamType::Enum) {
    if (edited) request.value = value;
    return request;
  }
  if (ImGui::IsItemActivated() || (edited && state.active != key)) state = {key, value, false};
  if (state.active != key) return request;
  if (edited) state.value = value;
  const bool done = ImGui::IsItemDeactivated(), changed = state.value != param.value;
  // Digits come one by one, and half a number is none; a slider's values are all meant.
  const bool slides = edited && ImGui::IsMouseDown(ImGuiMouseButton_Left) && description.type != ParamType::String;
  if (changed && (done || (slides && !description.specialises))) {
    request.value = state.value;
    request.continues = state.sent;
    state.sent = true;
  }
  if (done || !ImGui::IsItemActive()) state = {};
  return request;
}

}  // namespace

bool isLogarithmic(const ParamDescription& param) {
  constexpr double kDecades = 100.0;
  return param.low && param.high && *param.low > 0.0 && *param.high >= *param.low * kDecades;
}

float rounded(float value, const ParamDescription& param) {
  if (value == 0.0f || !std::isfinite(value)) return value;
  if (param.low && value <= static_cast<float>(*param.low)) return static_cast<float>(*param.low);
  if (param.high && value >= static_cast<float>(*param.high)) return static_cast<float>(*param.high);
  // A slider has some hundreds of pixels: three digits of the number, or so many steps over the range.
  constexpr double kDigits = 3.0, kSteps = 500.0;
  const bool linear = param.low && param.high && !isLogarithmic(param);
  const double step = linear ? std::pow(10.0, std::floor(std::log10((*param.high - *param.low) / kSteps)))
                             : std::pow(10.0, std::floor(std::log10(std::abs(double{value}))) - kDigits + 1.0);
  double nearest = std::round(value / step) * step;
  if (!std::isfinite(nearest)) return value;
  if (param.low) nearest = std::max(nearest, *param.low);
  if (param.high) nearest = std::min(nearest, *param.high);
  return static_cast<float>(nearest);
}

ParamRequest drawParam(Ui& ui, const std::string& pass, const ParamModel& param, float width, ParamWidgetState& state) {
  const ParamDescription& description = param.description;
  const std::string key = pass + "." + description.name;
  ImGui::PushID(description.name.c_str());
  const float left = ImGui::GetCursorPosX();
  const float resetWidth = ImGui::GetFrameHeight() + ImGui::GetStyle().ItemSpacing.x;
  constexpr float kNameShare = 0.5f;
  drawName(ui, param);
  ImGui::SameLine();
  ImGui::SetCursorPosX(std::max(left + width * kNameShare, ImGui::GetCursorPosX()));
  ImGui::SetNextItemWidth(std::max(left + width - resetWidth - ImGui::GetCursorPosX(), ImGui::GetFontSize() * 3.0f));
  ParamValue value = state.active == key ? state.value : param.value;
  const bool edited = editValue(ui, value, description);
  ui.marks.last(description.name);
  if (!ImGui::IsItemActive()) hint(param.tooltip);
  ParamRequest request = follow(edited, key, param, value, state);
  if (param.changed || !param.problems.empty()) {
    ImGui::SameLine();
    ImGui::SetCursorPosX(left + width - ImGui::GetFrameHeight());
    const Marks::Scope scope(ui.marks, description.name);
    request.reset = ImGui::Button("\xc3\x97", {ImGui::GetFrameHeight(), 0.0f});
    ui.marks.last("reset");
    hint("back to the default, " + toText(description.defaultValue));
  }
  for (const std::string& problem : param.problems) {
    wrapped(problem, palette().bad, left + width);
  }
  ImGui::PopID();
  return request;
}

}  // namespace weir::view
