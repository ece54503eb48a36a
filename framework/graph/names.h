// Which names a graph file may give, and how a message lists the valid ones.
#pragma once

#include <string>
#include <vector>

namespace weir::graph {

/// Passes and outputs: letters, digits, '_' and '-', so that "pass.port@previous" and "--set pass.param=value" have one
/// reading.
bool isName(const std::string& name);
inline constexpr const char* kNameRule = "letters, digits, '_' and '-'";

/// "a, b, c", shortened when there are many; "none" for an empty list.
std::string listed(const std::vector<std::string>& names);

/// The names of named things.
template <typename Items>
std::vector<std::string> namesOf(const Items& items) {
  std::vector<std::string> names;
  for (const auto& item : items) names.push_back(item.name);
  return names;
}

}  // namespace weir::graph
