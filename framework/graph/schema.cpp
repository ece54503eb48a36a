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

Json param(const ParamDescription& p) {
  Json json;
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
    json["default"] = Json::parse(fmt::format("{}", *real));
  else
    std::visit([&](const auto& value) { json["default"] = value; }, p.defaultValue);
  const std::string doc = p.unit.empty() ? p.doc : fmt::format("{}{}[{}]", p.doc, p.doc.empty() ? "" : " ", p.unit);
  if (!doc.empty()) json["description"] = doc;
  return json;
}

Json pass(const PassDescription& description) {
  Json inputs = Json::object(), params = Json::object(), required = Json::array({"type"});
  Json requiredInputs = Json::array();
  for (const PortDescription& port : description.inputs) {
    inputs[port.name] = {{"$ref", "#/definitions/reference"}, {"description", describe(port.type)}};
    if (!port.doc.empty()) inputs[port.name]["description"] = port.doc + " (" + describe(port.type) + ")";
    if (port.required) requiredInputs.push_back(port.name);
  }
  for (const ParamDescription& p : description.params) params[p.name] = param(p);
  Json inputsObject = object(std::move(inputs));
  if (!requiredInputs.empty()) {
    inputsObject["required"] = std::move(requiredInputs);
    required.push_back("inputs");
  }
  Json json = object({{"type", {{"const", description.type}}},
                      {"enabled", {{"type", "boolean"}, {"default", true}}},
                      {"inputs", std::move(inputsObject)},
                      {"params", object(std::move(params))}});
  json["required"] = std::move(required);
  if (!description.text.empty()) json["description"] = description.text;
  return json;
}

}  // namespace

std::string schemaJson(const PassCatalog& catalog) {
  Json definitions = {{"reference", {{"type", "string"}, {"pattern", kReference}}}};
  Json choices = Json::array();
  for (const std::string& type : catalog.types()) {
    const PassDescription* description = catalog.find(type);
    if (!description) continue;
    definitions[type] = pass(*description);
    choices.push_back({{"$ref", "#/definitions/" + type}});
  }
  const Json anyPass = choices.empty() ? Json{{"type", "object"}} : Json{{"oneOf", std::move(choices)}};
  Json schema = {{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", "Weir graph"}};
  schema.update(object({{"$schema", {{"type", "string"}}},
                        {"version", {{"const", 1}}},
                        {"name", {{"type", "string"}}},
                        {"description", {{"type", "string"}}},
                        {"passes",
                         {{"type", "object"},
                          {"minProperties", 1},
                          {"propertyNames", {{"pattern", kName}}},
                          {"additionalProperties", anyPass}}},
                        {"outputs",
                         {{"type", "object"},
                          {"minProperties", 1},
                          {"propertyNames", {{"pattern", kName}}},
                          {"additionalProperties", {{"$ref", "#/definitions/reference"}}}}}}));
  schema["required"] = {"version", "passes", "outputs"};
  schema["definitions"] = std::move(definitions);
  return schema.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace weir::graph
