// Building and asking a pass description; description_check.cpp holds the rules that it must keep.
#include <weir/pass/description.h>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace weir {
namespace {

constexpr const char* kNeedNames[] = {"scene.geometry",     "scene.materials", "scene.lights", "scene.environment",
                                      "scene.acceleration", "frame.camera",    "frame.index"};
static_assert(std::size(kNeedNames) == static_cast<size_t>(Need::Count));

template <typename T>
const T* findByName(const std::vector<T>& items, std::string_view name) {
  const auto found = std::find_if(items.begin(), items.end(), [&](const T& item) { return item.name == name; });
  return found == items.end() ? nullptr : &*found;
}

}  // namespace

const char* needName(Need need) {
  return need < Need::Count ? kNeedNames[static_cast<size_t>(need)] : "unknown";
}

std::optional<Need> needFromName(std::string_view name) {
  for (size_t i = 0; i < std::size(kNeedNames); ++i)
    if (name == kNeedNames[i]) return static_cast<Need>(i);
  return std::nullopt;
}

const char* paramTypeName(ParamType type) {
  switch (type) {
    case ParamType::Bool:
      return "bool";
    case ParamType::Int:
      return "int";
    case ParamType::Float:
      return "float";
    case ParamType::Enum:
      return "enum";
    case ParamType::String:
      return "string";
  }
  return "unknown";
}

std::string toText(const ParamValue& value) {
  return std::visit([](const auto& v) { return fmt::format("{}", v); }, value);
}

// -------------------------------------------------------------------------------------------------- modifiers

using Port = PassDescription::Port;
using Param = PassDescription::Param;

Port& Port::doc(std::string text) {
  return d_.doc = std::move(text), *this;
}
Port& Port::optional() {
  return d_.required = false, *this;
}
Port& Port::absentWhenDisabled() {
  return d_.absentWhenDisabled = true, *this;
}
Port& Port::passesThrough(std::string input) {
  return d_.passesThrough = std::move(input), *this;
}
Port& Port::times(std::string intParam) {
  return d_.type.perPixelFromParam = std::move(intParam), *this;
}
Port& Port::countOf(std::string input) {
  return d_.type.perPixelFromInput = std::move(input), *this;
}
Port& Port::anyCount() {
  return d_.type.anyPerPixel = true, *this;
}
Port& Port::scale(uint32_t numerator, uint32_t denominator) {
  d_.type.scaleNumerator = numerator;
  d_.type.scaleDenominator = denominator;
  return *this;
}
Port& Port::radiance() {
  return d_.meaning = Meaning::Radiance, *this;
}
Port& Port::display() {
  return d_.meaning = Meaning::Display, *this;
}

Param& Param::range(double low, double high) {
  d_.low = low;
  d_.high = high;
  return *this;
}
Param& Param::oneOf(std::vector<std::string> choices) {
  d_.type = ParamType::Enum;
  d_.choices = std::move(choices);
  return *this;
}
Param& Param::unit(std::string text) {
  return d_.unit = std::move(text), *this;
}
Param& Param::doc(std::string text) {
  return d_.doc = std::move(text), *this;
}
Param& Param::specialises() {
  return d_.specialises = true, *this;
}

// ------------------------------------------------------------------------------------------------ description

PassDescription& PassDescription::doc(std::string line) {
  return text = std::move(line), *this;
}

Port PassDescription::input(std::string name, PortType portType) {
  PortDescription& port = inputs.emplace_back();
  port.name = std::move(name);
  port.type = std::move(portType);
  return Port(port);
}

Port PassDescription::output(std::string name, PortType portType) {
  PortDescription& port = outputs.emplace_back();
  port.name = std::move(name);
  port.type = std::move(portType);
  return Port(port);
}

namespace {

Param addParam(std::vector<ParamDescription>& params, std::string name, ParamType type, ParamValue value) {
  ParamDescription& param = params.emplace_back();
  param.name = std::move(name);
  param.type = type;
  param.defaultValue = std::move(value);
  return Param(param);
}

}  // namespace

Param PassDescription::param(std::string name, bool value) {
  return addParam(params, std::move(name), ParamType::Bool, value);
}
Param PassDescription::param(std::string name, int value) {
  return addParam(params, std::move(name), ParamType::Int, int32_t{value});
}
Param PassDescription::param(std::string name, float value) {
  return addParam(params, std::move(name), ParamType::Float, value);
}
Param PassDescription::param(std::string name, const char* value) {
  return addParam(params, std::move(name), ParamType::String, std::string(value));
}

PassDescription& PassDescription::needs(Need need) {
  if (!has(need)) wants.push_back({need, false});
  return *this;
}
PassDescription& PassDescription::needsPrevious(Need need) {
  if (!has(need, true)) wants.push_back({need, true});
  return *this;
}

PassDescription& PassDescription::rasterises() {
  draws = true;
  return *this;
}

bool PassDescription::has(Need need, bool previous) const {
  return std::any_of(wants.begin(), wants.end(),
                     [&](const NeedDescription& want) { return want.need == need && want.previous == previous; });
}

const PortDescription* PassDescription::findInput(std::string_view name) const {
  return findByName(inputs, name);
}
const PortDescription* PassDescription::findOutput(std::string_view name) const {
  return findByName(outputs, name);
}
const ParamDescription* PassDescription::findParam(std::string_view name) const {
  return findByName(params, name);
}

}  // namespace weir
