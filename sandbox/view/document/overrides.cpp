#include "view/document/overrides.h"

#include "view/document/json_text.h"

namespace weir::view {
namespace {

bool isText(const PassDescription* type, const std::string& param) {
  const ParamDescription* description = type ? type->findParam(param) : nullptr;
  return description && (description->type == ParamType::Enum || description->type == ParamType::String);
}

std::string jsonOf(const graph::ParamEntry& entry, const PassDescription* type) {
  if (isText(type, entry.name)) return quoted(entry.text);
  const auto* text = std::get_if<std::string>(&entry.value);
  return text ? quoted(*text) : graph::toText(entry.value);
}

}  // namespace

void applyOverrides(Document& document, const graph::Overrides& overrides, const graph::PassCatalog& catalog) {
  constexpr uint32_t kAnySize = 64;  // no finding about an override asks how large the frame is
  std::vector<graph::Diagnostic> findings, all;
  graph::Description description = document.description();
  graph::apply(description, overrides, findings);
  graph::compile(description, catalog, kAnySize, kAnySize, all);
  for (graph::Diagnostic& finding : all)
    if (finding.file.starts_with("--")) findings.push_back(std::move(finding));
  if (!findings.empty()) throw graph::GraphError(std::move(findings));

  Document edited = document;
  for (const graph::PassEntry& pass : description.passes) {
    if (!pass.enabledOrigin.empty()) edited.setEnabled(pass.name, pass.enabled);
    for (const graph::ParamEntry& param : pass.params)
      if (!param.origin.empty()) edited.setParamText(pass.name, param.name, jsonOf(param, catalog.find(pass.type)));
  }
  document.replace(edited.text(), "the command line's changes");
}

}  // namespace weir::view
