// `weir passes`: every pass of every plugin found.
#include "commands.h"
#include "graph_options.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <memory>

namespace {

using weir::ParamDescription;
using weir::ParamType;
using weir::PassDescription;
using weir::PortDescription;
using Json = nlohmann::ordered_json;

std::string countText(const weir::PortType& type) {
  if (type.fixedCount != 0) return fmt::format("{} elements", type.fixedCount);
  std::string text;
  if (type.anyPerPixel)
    text = "any number a pixel";
  else if (!type.perPixelFromParam.empty())
    text = fmt::format("'{}' a pixel", type.perPixelFromParam);
  else if (!type.perPixelFromInput.empty())
    text = fmt::format("as many a pixel as '{}'", type.perPixelFromInput);
  else if (type.perPixel != 1)
    text = fmt::format("{} a pixel", type.perPixel);
  if (type.scaleNumerator != type.scaleDenominator)
    text += fmt::format("{}at {}/{} size", text.empty() ? "" : ", ", type.scaleNumerator, type.scaleDenominator);
  return text;
}

std::string rangeText(const ParamDescription& param) {
  if (param.type == ParamType::Enum) return fmt::format("{}", fmt::join(param.choices, " | "));
  return param.low && param.high ? fmt::format("{} … {}", *param.low, *param.high) : std::string();
}

std::string needText(const weir::NeedDescription& want) {
  return weir::needName(want.need) + std::string(want.previous ? "@previous" : "");
}

void printPort(const char* side, const PortDescription& port) {
  std::string text = weir::describe(port.type);
  if (const std::string count = countText(port.type); !count.empty()) text += ", " + count;
  if (!port.required) text += ", optional";
  if (!port.passesThrough.empty()) text += fmt::format(", stands aside for '{}'", port.passesThrough);
  fmt::print("  {:<6} {:<18} {}{}\n", side, port.name, text, port.doc.empty() ? "" : " – " + port.doc);
}

void printPass(const PassDescription& pass) {
  fmt::print("{}{}\n", pass.type, pass.text.empty() ? "" : "\n  " + pass.text);
  for (const PortDescription& port : pass.inputs) printPort("in", port);
  for (const PortDescription& port : pass.outputs) printPort("out", port);
  for (const ParamDescription& param : pass.params) {
    std::string text = fmt::format("{} = {}", weir::paramTypeName(param.type), weir::toText(param.defaultValue));
    if (!param.unit.empty()) text += " " + param.unit;
    if (const std::string range = rangeText(param); !range.empty()) text += fmt::format(" [{}]", range);
    fmt::print("  {:<6} {:<18} {}{}\n", "param", param.name, text, param.doc.empty() ? "" : " – " + param.doc);
  }
  for (const weir::NeedDescription& want : pass.wants) fmt::print("  {:<6} {}\n", "takes", needText(want));
  fmt::print("\n");
}

Json portJson(const PortDescription& port, bool isInput) {
  const weir::PortType& type = port.type;
  Json json = {{"name", port.name}, {"doc", port.doc}};
  if (type.kind == weir::PortKind::Image) {
    json["kind"] = "image";
    json["format"] = weir::formatName(type.format);
  } else {
    const weir::Layout& layout = type.layout;
    json["kind"] = "buffer";
    json["layout"] = {{"name", layout.name},
                      {"version", layout.version},
                      {"stride", layout.stride},
                      {"hash", fmt::format("{:#018x}", layout.hash)}};
    if (type.fixedCount != 0)
      json["elements"] = type.fixedCount;
    else if (type.anyPerPixel)
      json["perPixel"] = "any";
    else if (!type.perPixelFromParam.empty())
      json["perPixel"] = {{"param", type.perPixelFromParam}};
    else if (!type.perPixelFromInput.empty())
      json["perPixel"] = {{"input", type.perPixelFromInput}};
    else
      json["perPixel"] = type.perPixel;
  }
  json["scale"] = {type.scaleNumerator, type.scaleDenominator};
  if (isInput)
    json["required"] = port.required;
  else if (!port.passesThrough.empty())
    json["passesThrough"] = port.passesThrough;
  return json;
}

Json paramJson(const ParamDescription& param) {
  Json json = {{"name", param.name}, {"type", weir::paramTypeName(param.type)}};
  std::visit([&](const auto& value) { json["default"] = value; }, param.defaultValue);
  if (param.low) json["low"] = *param.low;
  if (param.high) json["high"] = *param.high;
  if (!param.choices.empty()) json["choices"] = param.choices;
  json["unit"] = param.unit;
  json["doc"] = param.doc;
  json["specialises"] = param.specialises;
  return json;
}

Json passJson(const PassDescription& pass) {
  Json json = {{"type", pass.type},        {"doc", pass.text},        {"inputs", Json::array()},
               {"outputs", Json::array()}, {"params", Json::array()}, {"needs", Json::array()}};
  for (const PortDescription& port : pass.inputs) json["inputs"].push_back(portJson(port, true));
  for (const PortDescription& port : pass.outputs) json["outputs"].push_back(portJson(port, false));
  for (const ParamDescription& param : pass.params) json["params"].push_back(paramJson(param));
  for (const weir::NeedDescription& want : pass.wants) json["needs"].push_back(needText(want));
  return json;
}

void list(weir::Registry& registry, bool asJson) {
  const std::vector<std::string> types = registry.types();
  if (!asJson) {
    for (const std::string& type : types) printPass(*registry.find(type));
    // A plugin that can't be used takes nothing from the others: said, but no failure.
    for (const weir::PluginProblem& problem : registry.problems()) fmt::print(stderr, "weir: {}\n", problem.message);
    if (types.empty()) fmt::print(stderr, "weir: no pass was found; see --plugin-path\n");
    return;
  }
  Json json = {{"passes", Json::array()}, {"problems", Json::array()}};
  for (const std::string& type : types) json["passes"].push_back(passJson(*registry.find(type)));
  for (const weir::PluginProblem& problem : registry.problems())
    json["problems"].push_back({{"plugin", problem.plugin}, {"message", problem.message}});
  fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
}

}  // namespace

void addPassesCommand(CLI::App& app) {
  struct Options {
    bool json = false;
    std::vector<std::string> pluginPath;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("passes", "list every pass of every plugin found: ports and parameters");
  command->add_flag("--json", options->json, "as JSON");
  addPluginPath(*command, options->pluginPath);
  command->callback([options] {
    weir::Registry registry(weir::pluginSearchPath(options->pluginPath));
    list(registry, options->json);
  });
}
