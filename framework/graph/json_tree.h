// JSON as a tree that knows the line of every key and value, which ordinary JSON libraries throw away.
#pragma once

#include <weir/graph/description.h>

#include <cstddef>
#include <string>
#include <vector>

namespace weir::graph {

struct JsonMember;

struct JsonValue {
  enum class Kind : uint8_t { Scalar, Object, Array };
  Kind kind = Kind::Scalar;
  RawValue scalar = nullptr;
  std::vector<JsonMember> members;  ///< objects; a repeated key is left out
  std::vector<JsonValue> elements;  ///< arrays, where they are asked for
  int line = 0;                     ///< 1-based; where the value starts
  bool isObject() const { return kind == Kind::Object; }
  const char* kindName() const;  ///< "a text", "an object", …
};

struct JsonMember {
  std::string key;
  int line = 0;  ///< of the key
  JsonValue value;
};

/// Objects inside objects deeper than this are refused.
inline constexpr int kDeepestJson = 64;
/// Longer keys and texts, in bytes, are refused: they are repeated in paths and messages.
inline constexpr size_t kLongestKey = 1024, kLongestText = 65536;

/// False, with a diagnostic, when the text is no JSON, too deep, or has an overlong key or text. Repeated keys are
/// diagnostics too, but do not stop the reading. The elements of arrays are checked and dropped, as no graph file has
/// any; `mostElements` above 0: they are kept, and more of them in the file than that are refused.
bool readJson(const std::string& text, const std::string& file, JsonValue& root, std::vector<Diagnostic>& diagnostics,
              size_t mostElements = 0);

}  // namespace weir::graph
