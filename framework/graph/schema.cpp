#include <weir/graph/names.h>
#include <weir/graph/schema.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace weir::graph {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kReference = "^[A-Za-z0-9_-]+\\.[A-Za-z0-9_-]+(@previous)?$";
constexpr const char* kName = "^[A-Za-z0-9_-]+$";

Json object(Json properties) {
  return {{"type", "object"}, {"properties", std::move(properties)}, {"additionalProperties", false}};
}

/// A number as people write it: 0.1 and not 0.10000000149.
std::string numberText(float value) {
  return fmt::format("{}", value);
}

/// "Lights drawn for each pixel. Integer from 1 to 1024, default 32, in pixels."
std::string describe(const ParamDescription& p) {
  std::string text = p.doc.empty() ? "" : p.doc + ". ";
  switch (p.type) {
    case ParamType::Bool:
      text += "True or false";
      break;
    case ParamType::Int:
      text += "Integer";
      break;
    case ParamType::Float:
      text += "Number";
      break;
    case ParamType::Enum:
      text += fmt::format("One of {}", fmt::join(p.choices, ", "));
      break;
    case ParamType::String:
      text += "Text";
      break;
  }
  if (p.low && p.high)
    text += fmt::format(" from {} to {}", *p.low, *p.high);
  else if (p.low || p.high)
    text += fmt::format(" of at {} {}", p.low ? "least" : "most", p.low ? *p.low : *p.high);
  if (const auto* real = std::get_if<float>(&p.defaultValue))
    text += ", default " + numberText(*real);
  else if (const std::string value = weir::toText(p.defaultValue); !value.empty())
    text += ", default " + value;
  if (!p.unit.empty()) text += ", in " + p.unit;
  return text + ".";
}

Json param(const ParamDescription& p) {
  Json json = {{"description", describe(p)}};
  switch (p.type) {
    case ParamType::Bool:
      json["type"] = "boolean";
      break;
    case ParamType::Int:
      json["type"] = "integer";
      break;
    case ParamType::Float:
      json["type"] = "number";
      break;
    case ParamType::Enum:
      json["enum"] = p.choices;
      break;
    case ParamType::String:
      json["type"] = "string";
      break;
  }
  if (p.low) json["minimum"] = *p.low;
  if (p.high) json["maximum"] = *p.high;
  if (const auto* real = std::get_if<float>(&p.defaultValue))
    json["default"] = Json::parse(numberText(*real));
  else
    std::visit([&](const auto& value) { json["default"] = value; }, p.defaultValue);
  return json;
}

/// "Reservoir v1" or "image RGBA32F": the stride and hash of a layout say nothing to whoever writes a graph.
std::string carries(const PortType& type) {
  return type.kind == PortKind::Image ? weir::describe(type)
                                      : fmt::format("{} v{}", type.layout.name, type.layout.version);
}

/// "Last frame's samples. Required; Reservoir v1, any number a pixel, at 1/2 of the frame's size."
std::string describe(const PortDescription& port) {
  std::string text = port.doc.empty() ? "" : port.doc + ". ";
  text += fmt::format("{}; {}", port.required ? "Required" : "May stay unconnected", carries(port.type));
  const PortType& type = port.type;
  if (type.fixedCount != 0)
    text += fmt::format(" with {} elements", type.fixedCount);
  else if (type.anyPerPixel)
    text += ", any number a pixel";
  else if (type.perPixel != 1)
    text += fmt::format(", {} a pixel", type.perPixel);
  if (type.scaleNumerator != type.scaleDenominator)
    text += fmt::format(", at {}/{} of the frame's size", type.scaleNumerator, type.scaleDenominator);
  return text + ".";
}

/// "Merges … Outputs: surface (PackedSurface …), color (image RGBA32F)."
std::string describe(const PassDescription& pass) {
  std::string text = pass.text.empty() ? pass.type : pass.text;
  text += ". Outputs: ";
  if (pass.outputs.empty()) text += "none";
  for (const PortDescription& port : pass.outputs) {
    if (&port != &pass.outputs.front()) text += ", ";
    text += fmt::format("{} ({})", port.name, carries(port.type));
  }
  return text + ".";
}

/// What a pass of that type may have beside its type: inputs and parameters.
Json pass(const PassDescription& description) {
  Json inputs = Json::object(), params = Json::object(), requiredInputs = Json::array();
  for (const PortDescription& port : description.inputs) {
    // Beside a "$ref" draft-07 ignores everything, a description too; so it stands inside of "allOf".
    inputs[port.name] = {{"description", describe(port)}, {"allOf", {{{"$ref", "#/definitions/reference"}}}}};
    if (port.required) requiredInputs.push_back(port.name);
  }
  for (const ParamDescription& p : description.params) params[p.name] = param(p);
  Json inputsObject = object(std::move(inputs));
  const bool needsInputs = !requiredInputs.empty();
  if (needsInputs) inputsObject["required"] = std::move(requiredInputs);
  Json json = {{"description", describe(description)},
               {"properties", {{"inputs", std::move(inputsObject)}, {"params", object(std::move(params))}}}};
  if (needsInputs) json["required"] = {"inputs"};
  return json;
}

}  // namespace

std::string schemaJson(const PassCatalog& catalog) {
  Json definitions = {{"reference",
                       {{"description", "What is read: \"pass.port\", or \"pass.port@previous\" for its last frame."},
                        {"type", "string"},
                        {"pattern", kReference}}}};
  // A choice by "type" and not "oneOf": where something is wrong inside of a pass, an editor then says what, instead of
  // that it is none of all the passes there are.
  Json types = Json::array(), choices = Json::array();
  for (const std::string& type : catalog.types()) {
    const PassDescription* description = catalog.find(type);
    if (!description) continue;
    definitions[type] = pass(*description);
    types.push_back(type);
    choices.push_back({{"if", {{"properties", {{"type", {{"const", type}}}}}, {"required", {"type"}}}},
                       {"then", {{"$ref", "#/definitions/" + type}}}});
  }
  Json anyPass =
      object({{"type", {{"description", "The pass, as \"plugin.Pass\"."}, {"type", "string"}}},
              {"enabled",
               {{"description", "Whether it runs. False: each output is what the pass passes through."},
                {"type", "boolean"},
                {"default", true}}},
              {"inputs", {{"description", "What each input reads."}, {"type", "object"}}},
              {"params", {{"description", "Parameters that differ from their defaults."}, {"type", "object"}}}});
  anyPass["required"] = {"type"};
  if (!types.empty()) {
    anyPass["properties"]["type"]["enum"] = std::move(types);
    anyPass["allOf"] = std::move(choices);
  }
  definitions["pass"] = std::move(anyPass);
  Json schema = {{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", "Weir graph"}};
  schema.update(object({{"$schema", {{"type", "string"}}},
                        {"version", {{"description", "Of the format."}, {"const", 1}}},
                        {"name", {{"description", "Of the graph; otherwise that of its file."}, {"type", "string"}}},
                        {"description", {{"type", "string"}}},
                        {"passes",
                         {{"description", "Passes by name. Order comes from what they read of each other."},
                          {"type", "object"},
                          {"minProperties", 1},
                          {"propertyNames", {{"pattern", kName}}},
                          {"additionalProperties", {{"$ref", "#/definitions/pass"}}}}},
                        {"outputs",
                         {{"description", "What the graph gives, by name."},
                          {"type", "object"},
                          {"minProperties", 1},
                          {"propertyNames", {{"pattern", kName}}},
                          {"additionalProperties", {{"$ref", "#/definitions/reference"}}}}}}));
  schema["required"] = {"version", "passes", "outputs"};
  schema["definitions"] = std::move(definitions);
  return schema.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace weir::graph
