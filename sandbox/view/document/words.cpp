#include "view/document/words.h"

#include "view/document/model.h"

#include <weir/graph/params.h>

#include <fmt/format.h>

#include <variant>

namespace weir::view {
namespace {

std::string countWords(const PortType& type, const std::vector<ParamModel>& params) {
  if (type.fixedCount != 0) return fmt::format(", {} elements", type.fixedCount);
  if (type.anyPerPixel) return ", any number a pixel";
  if (!type.perPixelFromInput.empty()) return fmt::format(", as many a pixel as '{}'", type.perPixelFromInput);
  if (type.perPixelFromParam.empty())
    return type.perPixel == 1 ? ", 1 a pixel" : fmt::format(", {} a pixel", type.perPixel);
  for (const ParamModel& param : params)
    if (param.description.name == type.perPixelFromParam) return fmt::format(", {} a pixel", toText(param.value));
  return fmt::format(", '{}' a pixel", type.perPixelFromParam);
}

}  // namespace

std::string paramWords(const ParamDescription& param) {
  std::string text = param.doc;
  const auto line = [&text](const std::string& more) { text += (text.empty() ? "" : "\n") + more; };
  const std::string fits = graph::expectedText(param);
  if (param.type != ParamType::Bool)
    line(fits + (param.unit.empty() || param.type == ParamType::Enum ? "" : ", " + param.unit));
  const std::string standard = toText(param.defaultValue);
  line("default: " + (standard.empty() ? "\"\"" : standard));
  if (param.specialises) line("compiled into the shader: a change rebuilds pipelines");
  return text;
}

std::string portWords(const PortType& type, const std::vector<ParamModel>& params) {
  std::string text = type.kind == PortKind::Image ? fmt::format("{} image", formatName(type.format))
                                                  : type.layout.name + countWords(type, params);
  if (type.fixedCount == 0 && type.scaleNumerator != type.scaleDenominator)
    text += fmt::format(", {}/{} of the frame's size", type.scaleNumerator, type.scaleDenominator);
  return text;
}

}  // namespace weir::view
