// Which names a graph file may give, and how a message lists the valid ones.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace weir::graph {

/// Passes and outputs: letters, digits, '_' and '-', so that "pass.port@previous" and "--set pass.param=value" have one
/// reading.
bool isName(const std::string& name);
inline constexpr const char* kNameRule = "letters, digits, '_' and '-'";

/// "a, b, c", shortened when there are many; "none" for an empty list.
std::string listed(const std::vector<std::string>& names);

/// Nearest names for the slips of one graph. Looking through a list takes time for each of them, so that a file of very
/// many slips would take minutes: beyond a budget that no file of people's reaches, nothing is nearest.
class NearestNames {
 public:
  /// As weir::nearestName.
  std::string find(const std::string& name, const std::vector<std::string>& among);

 private:
  uint64_t left_ = 20'000'000;  ///< pairs of characters to compare
};

/// The names of named things.
template <typename Items>
std::vector<std::string> namesOf(const Items& items) {
  std::vector<std::string> names;
  for (const auto& item : items) names.push_back(item.name);
  return names;
}

}  // namespace weir::graph
