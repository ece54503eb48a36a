#include "view/ui/marks.h"

#include <imgui.h>

namespace weir::view {

void Marks::begin(bool looked) {
  looked_ = wanted_ && looked;
  if (!looked_) return;
  found_.clear();
  scope_.clear();
}

void Marks::last(std::string_view name) {
  if (!looked_) return;
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  const std::string whole = scope_ + std::string(name);
  found_[whole] = {{{low.x, low.y}, {high.x, high.y}}, ImGui::IsItemVisible()};
  if (whole == revealed_) {
    ImGui::SetScrollHereY(0.5f);
    revealed_.clear();
  }
}

void Marks::place(std::string_view name, const Rectangle& where) {
  if (looked_) found_[scope_ + std::string(name)] = {where, true};
}

Marks::Scope::Scope(Marks& marks, std::string_view name) : marks_(marks), length_(marks.scope_.size()) {
  if (marks.looked_) (marks.scope_ += name) += '/';
}

Marks::Scope::~Scope() {
  marks_.scope_.resize(length_);
}

std::optional<Marks::Found> Marks::find(const std::string& name) const {
  const auto at = found_.find(name);
  return at == found_.end() ? std::nullopt : std::optional(at->second);
}

std::vector<std::string> Marks::names() const {
  std::vector<std::string> names;
  for (const auto& [name, where] : found_) names.push_back(name);
  return names;
}

}  // namespace weir::view
