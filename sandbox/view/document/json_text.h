// Edits of JSON as text: what is not edited stays as it was written, byte for byte, with its order, spaces and
// spelling. Texts are valid JSON without repeated keys: graph::parse has seen them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace weir::view {

struct JsonMemberSpan;

/// Where a value lies in its text, in bytes.
struct JsonSpan {
  size_t begin = 0, end = 0;
  std::vector<JsonMemberSpan> members;  ///< of an object, in the text's order
};

struct JsonMemberSpan {
  std::string key;
  size_t begin = 0;  ///< of the key
  JsonSpan value;
};

/// The keys that lead from the root to a value.
using JsonPath = std::vector<std::string>;

JsonSpan spanOf(const std::string& json);
/// nullptr when there is none.
const JsonSpan* findSpan(const JsonSpan& root, const JsonPath& path);
/// The value as it is written; empty when there is none.
std::string_view valueText(const std::string& json, const JsonPath& path);

/// A text as JSON. InputError when it is no UTF-8.
std::string quoted(const std::string& text);

/// The text with this member's value replaced, or with the member at the end of its object, which must be there, laid
/// out as the object's members are.
std::string withMember(const std::string& json, const JsonPath& object, const std::string& key,
                       const std::string& value);
/// The text without this member; as it was when there is none.
std::string withoutMember(const std::string& json, const JsonPath& object, const std::string& key);

}  // namespace weir::view
