// Parameters: what the file or the command line says → values of the declared types.
#include <weir/core/text.h>
#include <weir/graph/checked.h>
#include <weir/graph/names.h>
#include <weir/graph/params.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace weir::graph {
namespace {

std::string rangeText(const ParamDescription& param) {
  std::string text = param.type == ParamType::Int ? "an integer" : "a number";
  if (param.low && param.high) text += fmt::format(" from {} to {}", *param.low, *param.high);
  return text;
}

std::optional<double> asNumber(const RawValue& value) {
  if (const auto* whole = std::get_if<int64_t>(&value)) return static_cast<double>(*whole);
  if (const auto* real = std::get_if<double>(&value)) return *real;
  return std::nullopt;
}

bool inRange(const ParamDescription& param, double value) {
  return !(param.low && value < *param.low) && !(param.high && value > *param.high);
}

std::string quoted(const ParamEntry& entry) {
  if (const auto* text = std::get_if<std::string>(&entry.value)) return fmt::format("'{}'", *text);
  return toText(entry.value);
}

}  // namespace

std::string expectedText(const ParamDescription& param) {
  switch (param.type) {
    case ParamType::Bool:
      return "true or false";
    case ParamType::Int:
    case ParamType::Float:
      return rangeText(param);
    case ParamType::Enum:
      return "one of: " + listed(param.choices);
    case ParamType::String:
      return "a text";
  }
  return "";
}

std::optional<ParamValue> readParam(const ParamDescription& param, const ParamEntry& entry) {
  const RawValue& value = entry.value;
  switch (param.type) {
    case ParamType::Bool:
      if (const bool* on = std::get_if<bool>(&value)) return *on;
      return std::nullopt;
    case ParamType::Int: {
      const std::optional<double> number = asNumber(value);  // 3.0 is a whole number, 3.5 is none
      if (!number || std::trunc(*number) != *number || !inRange(param, *number)) return std::nullopt;
      if (*number < std::numeric_limits<int32_t>::min() || *number > std::numeric_limits<int32_t>::max())
        return std::nullopt;
      return static_cast<int32_t>(*number);
    }
    case ParamType::Float: {
      const std::optional<double> number = asNumber(value);
      if (!number || std::abs(*number) > std::numeric_limits<float>::max() || !inRange(param, *number))
        return std::nullopt;
      return static_cast<float>(*number);
    }
    case ParamType::Enum:
    case ParamType::String: {
      // On the command line a text has no quotes, so one that looks like a number is still a text.
      const std::string* text = entry.origin.empty() ? std::get_if<std::string>(&value) : &entry.text;
      if (!text) return std::nullopt;
      if (param.type == ParamType::Enum &&
          std::find(param.choices.begin(), param.choices.end(), *text) == param.choices.end())
        return std::nullopt;
      return *text;
    }
  }
  return std::nullopt;
}

void bindParams(Node& node, Findings& findings) {
  for (const ParamDescription& param : node.type->params) node.params[param.name] = param.defaultValue;
  const auto path = [&](const ParamEntry& entry) {
    return fmt::format("passes.{}.params.{}", node.name(), entry.name);
  };
  for (const ParamEntry& entry : node.entry->params) {
    const ParamDescription* param = node.type->findParam(entry.name);
    if (!param) {
      const std::vector<std::string> names = namesOf(node.type->params);
      findings.add(entry.nameLine, path(entry),
                   fmt::format("unknown parameter '{}'; {} has: {}", entry.name, node.type->type, listed(names)),
                   nearestName(entry.name, names), entry.origin);
      continue;
    }
    if (std::optional<ParamValue> value = readParam(*param, entry)) {
      node.params[param->name] = std::move(*value);
      continue;
    }
    const std::string nearest = param->type == ParamType::Enum ? nearestName(toText(entry.value), param->choices) : "";
    findings.add(entry.line, path(entry),
                 fmt::format("bad value {} for '{}'; expected {}", quoted(entry), entry.name, expectedText(*param)),
                 nearest, entry.origin);
  }
}

}  // namespace weir::graph
