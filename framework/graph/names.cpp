#include <weir/core/text.h>
#include <weir/graph/names.h>

#include <fmt/format.h>

#include <algorithm>

namespace weir::graph {

bool isName(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
}

std::string NearestNames::find(const std::string& name, const std::vector<std::string>& among) {
  for (const std::string& candidate : among) {
    left_ -= std::min<uint64_t>(left_, (name.size() + 1) * (candidate.size() + 1));
    if (left_ == 0) return "";
  }
  return nearestName(name, among);
}

std::string listed(const std::vector<std::string>& names) {
  constexpr size_t kMost = 12;
  if (names.empty()) return "none";
  std::string text;
  for (size_t i = 0; i < std::min(names.size(), kMost); ++i) text += (i > 0 ? ", " : "") + names[i];
  if (names.size() > kMost) text += fmt::format(", … {} more", names.size() - kMost);
  return text;
}

}  // namespace weir::graph
