#include <weir/graph/diagnostic.h>

#include <fmt/format.h>

#include <utility>

namespace weir::graph {
namespace {

std::string joined(const std::vector<Diagnostic>& diagnostics) {
  std::string text;
  for (const Diagnostic& diagnostic : diagnostics) {
    if (!text.empty()) text += '\n';
    text += diagnostic.text();
  }
  return text;
}

}  // namespace

std::string Diagnostic::text() const {
  std::string place = file;
  if (line > 0) place += fmt::format("{}{}", place.empty() ? "line " : ":", line);
  for (const std::string* part : {&path, &message}) {
    if (part->empty()) continue;
    if (!place.empty()) place += ": ";
    place += *part;
  }
  if (!nearest.empty()) place += fmt::format(" (nearest: '{}')", nearest);
  return place;
}

GraphError::GraphError(std::vector<Diagnostic> diagnostics)
    : InputError(joined(diagnostics)), diagnostics_(std::move(diagnostics)) {}

}  // namespace weir::graph
