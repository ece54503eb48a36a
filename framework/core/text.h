// Small text helpers that several rooms need.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace weir {

/// Damerau-Levenshtein distance, ignoring case.
int editDistance(std::string_view a, std::string_view b);

/// The candidate nearest to `name`, or an empty string when none is near enough to be a likely slip
/// (distance above a third of the longer name, at least 2).
std::string nearestName(std::string_view name, const std::vector<std::string>& candidates);

/// 64-bit FNV-1a; stable over runs and machines, used for layouts and cache keys, not for security.
constexpr uint64_t fnv1a(std::string_view text, uint64_t hash = 14695981039346656037ull) {
  for (char c : text) hash = (hash ^ static_cast<uint8_t>(c)) * 1099511628211ull;
  return hash;
}

}  // namespace weir
