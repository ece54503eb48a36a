// nlohmann's parser reports events without places. Its input here is an iterator that counts what was read: when an
// event arrives, the token's last character is among the characters read, followed by at most one more (after a
// number). No token spans lines, so "line breaks before the last character read" is the token's line.
#include <weir/graph/json_tree.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <unordered_map>

namespace weir::graph {

const char* JsonValue::kindName() const {
  if (kind == Kind::Object) return "an object";
  if (kind == Kind::Array) return "an array";
  constexpr const char* kNames[] = {"null", "a bool", "an integer", "a number", "a text"};
  static_assert(std::size(kNames) == std::variant_size_v<RawValue>);
  return kNames[scalar.index()];
}

namespace {

/// Where the parser is in the text.
struct Position {
  const std::string& text;
  size_t read = 0;     ///< characters handed out
  size_t counted = 0;  ///< of these, searched for line breaks
  int line = 1;        ///< of the character at `counted`
  int lineOfLastRead() {
    const size_t end = read > 0 ? read - 1 : 0;
    for (; counted < end; ++counted) line += text[counted] == '\n' ? 1 : 0;
    return line;
  }
};

class CountingIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  CountingIterator(Position& position, size_t at) : position_(&position), at_(at) {}
  reference operator*() const { return position_->text[at_]; }
  CountingIterator& operator++() {
    position_->read = std::max(position_->read, ++at_);
    return *this;
  }
  CountingIterator operator++(int) {
    CountingIterator before = *this;
    ++*this;
    return before;
  }
  bool operator==(const CountingIterator& other) const { return at_ == other.at_; }
  bool operator!=(const CountingIterator& other) const { return at_ != other.at_; }

 private:
  Position* position_;
  size_t at_;
};

/// Builds the tree from events. The names of its members are nlohmann's.
class Builder {
 public:
  Builder(Position& position, const std::string& file, JsonValue& root, std::vector<Diagnostic>& diagnostics,
          size_t mostElements)
      : position_(position), file_(file), root_(root), diagnostics_(diagnostics), mostElements_(mostElements) {}

  bool null() { return scalar(nullptr); }
  bool boolean(bool value) { return scalar(value); }
  bool number_integer(int64_t value) { return scalar(value); }
  bool number_unsigned(uint64_t value) {
    if (value > static_cast<uint64_t>(INT64_MAX)) return scalar(static_cast<double>(value));
    return scalar(static_cast<int64_t>(value));
  }
  bool number_float(double value, const std::string&) { return scalar(value); }
  bool string(std::string& value) {
    if (value.size() > kLongestText) return fail(tooLong("text", value, kLongestText));
    return scalar(std::move(value));
  }
  bool binary(nlohmann::json::binary_t&) { return false; }  // no such thing in JSON text

  bool start_object(size_t) { return open(JsonValue::Kind::Object); }
  bool end_object() { return close(); }
  bool start_array(size_t) { return open(JsonValue::Kind::Array); }
  bool end_array() { return close(); }

  bool key(std::string& name) {
    Level& level = levels_.back();
    level.line = position_.lineOfLastRead();
    if (name.size() > kLongestKey) return fail(tooLong("key", name, kLongestKey));
    level.key = std::move(name);
    const int first = level.lineOf(level.key);
    level.repeated = first > 0;
    if (level.repeated)
      diagnostics_.push_back({file_, level.line, path(),
                              fmt::format("key '{}' is repeated; it is first on line {}", level.key, first), ""});
    return true;
  }

  bool parse_error(size_t, const std::string& token, const nlohmann::json::exception& error) {
    std::string reason = error.what();
    // "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error …" says the place a second time.
    if (const size_t place = reason.find("column "); place != std::string::npos)
      if (const size_t colon = reason.find(": ", place); colon != std::string::npos) reason.erase(0, colon + 2);
    if (reason.starts_with("[json"))
      if (const size_t bracket = reason.find("] "); bracket != std::string::npos) reason.erase(0, bracket + 2);
    if (reason.starts_with("number overflow")) reason = fmt::format("the number {} is too large", shortened(token, 60));
    return fail("not valid JSON: " + shortened(reason));
  }

 private:
  /// An object or array that is not closed yet.
  struct Level {
    JsonValue value;
    std::string key;  ///< of the member being read
    int line = 0;     ///< of that key
    bool repeated = false;
    std::unordered_map<std::string, int> lines;  ///< of the members' keys, once there are many

    /// The line of the member of that name; 0 when there is none.
    int lineOf(const std::string& name) {
      constexpr size_t kMany = 16;
      if (value.members.size() < kMany) {
        for (const JsonMember& member : value.members)
          if (member.key == name) return member.line;
        return 0;
      }
      for (size_t i = lines.size(); i < value.members.size(); ++i)
        lines.emplace(value.members[i].key, value.members[i].line);
      const auto found = lines.find(name);
      return found == lines.end() ? 0 : found->second;
    }
  };

  static std::string tooLong(const char* what, const std::string& text, size_t most) {
    return fmt::format("a {} of {} bytes, '{}'; expected at most {}", what, text.size(), shortened(text, 60), most);
  }

  /// The beginning of a long text, cut between characters.
  static std::string shortened(const std::string& text, size_t most = 200) {
    if (text.size() <= most) return text;
    size_t end = most;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0u) == 0x80u) --end;
    return text.substr(0, end) + "…";
  }

  bool fail(std::string message) {
    diagnostics_.push_back({file_, position_.lineOfLastRead(), path(), std::move(message), ""});
    return false;
  }

  std::string path() const {
    std::string text;
    for (const Level& level : levels_) {
      if (level.key.empty()) continue;
      if (!text.empty()) text += '.';
      text += level.key;
    }
    return text;
  }

  bool scalar(RawValue value) {
    JsonValue json;
    json.scalar = std::move(value);
    json.line = position_.lineOfLastRead();
    return store(std::move(json));
  }

  bool open(JsonValue::Kind kind) {
    if (levels_.size() >= static_cast<size_t>(kDeepestJson))
      return fail(fmt::format("nested deeper than {} levels", kDeepestJson));
    Level level;
    level.value.kind = kind;
    level.value.line = position_.lineOfLastRead();
    levels_.push_back(std::move(level));
    return true;
  }

  bool close() {
    JsonValue value = std::move(levels_.back().value);
    levels_.pop_back();
    return store(std::move(value));
  }

  bool store(JsonValue value) {
    if (levels_.empty()) {
      root_ = std::move(value);
      return true;
    }
    Level& level = levels_.back();
    if (level.value.isObject() && !level.repeated) {
      level.value.members.push_back({std::move(level.key), level.line, std::move(value)});
    } else if (level.value.kind == JsonValue::Kind::Array && mostElements_ > 0) {
      if (++elements_ > mostElements_) return fail(fmt::format("more than {} elements of arrays", mostElements_));
      level.value.elements.push_back(std::move(value));
    }
    level.key.clear();
    return true;
  }

  Position& position_;
  const std::string& file_;
  JsonValue& root_;
  std::vector<Diagnostic>& diagnostics_;
  size_t mostElements_, elements_ = 0;
  std::vector<Level> levels_;
};

}  // namespace

bool readJson(const std::string& text, const std::string& file, JsonValue& root, std::vector<Diagnostic>& diagnostics,
              size_t mostElements) {
  Position position{text};
  Builder builder(position, file, root, diagnostics, mostElements);
  return nlohmann::json::sax_parse(CountingIterator(position, 0), CountingIterator(position, text.size()), &builder);
}

}  // namespace weir::graph
