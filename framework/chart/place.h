// A value inside of a JSON file and the way to it, so that whatever is wrong with it can be said with its place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace weir::chart {

using Json = nlohmann::ordered_json;

/// Longer texts are refused, in bytes.
inline constexpr size_t kLongestText = 65536;

/// Lives as long as the JSON that it points into. Every function throws InputError, which names file and place, when
/// the value is not what was asked for.
class Place {
 public:
  Place(const std::string& file, const Json& value) : file_(&file), value_(&value) {}

  const Json& json() const { return *value_; }
  const std::string& path() const { return path_; }  ///< such as "configurations[3].frame"; empty for the whole file

  /// The member of that name. InputError names the nearest one when it is missing.
  Place at(const std::string& key) const;
  /// The same, and nothing when it is missing or null.
  std::optional<Place> find(const std::string& key) const;
  Place element(size_t index) const;

  const Place& object() const;            ///< itself, which must be an object
  const Place& array(size_t most) const;  ///< itself, which must be an array of at most so many elements
  std::string text() const;
  double number() const;  ///< finite, which every JSON number that could be read is
  double atLeastZero() const;
  uint64_t count(uint64_t most) const;  ///< a whole number from 0 to `most`
  bool boolean() const;
  void scalar() const;  ///< a text, number or bool

  /// InputError: the place, what is wrong with it.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  Place child(const Json& value, std::string path) const;
  [[noreturn]] void expected(const char* what) const;

  const std::string* file_;
  const Json* value_;
  std::string path_;
};

}  // namespace weir::chart
