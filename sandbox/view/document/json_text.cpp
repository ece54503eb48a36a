#include "view/document/json_text.h"

#include <weir/core/error.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace weir::view {
namespace {

/// A line that a new member would make longer than this goes on in the next.
constexpr size_t kLongestLine = 120;

/// Reads the structure of JSON that is known to be valid.
class Scanner {
 public:
  explicit Scanner(const std::string& text) : text_(text) {}

  JsonSpan root() {
    if (text_.starts_with("\xef\xbb\xbf")) at_ = 3;  // a byte order mark, as Windows' editors write it
    skipSpace();
    return value();
  }

 private:
  char here() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  void skipSpace() { at_ = std::min(text_.find_first_not_of(" \t\r\n", at_), text_.size()); }

  JsonSpan value() {
    JsonSpan span;
    span.begin = at_;
    if (here() == '{')
      object(span);
    else if (here() == '[')
      array();
    else if (here() == '"')
      string();
    else
      at_ = std::min(text_.find_first_of(" \t\r\n,}]", at_), text_.size());
    span.end = at_;
    return span;
  }

  void object(JsonSpan& span) {
    for (next(); here() != '}' && here() != '\0'; comma()) {
      JsonMemberSpan member;
      member.begin = at_;
      string();
      member.key = keyOf(member.begin, at_);
      skipSpace();
      next();  // the colon
      member.value = value();
      skipSpace();
      span.members.push_back(std::move(member));
    }
    ++at_;
  }

  void array() {
    for (next(); here() != ']' && here() != '\0'; comma()) {
      value();
      skipSpace();
    }
    ++at_;
  }

  void next() {
    ++at_;
    skipSpace();
  }
  void comma() {
    if (here() == ',') next();
  }

  void string() {
    for (++at_; here() != '"' && at_ < text_.size(); ++at_)
      if (here() == '\\') ++at_;
    ++at_;
  }

  std::string keyOf(size_t begin, size_t end) const {
    std::string raw = text_.substr(begin + 1, end - begin - 2);
    if (raw.find('\\') == std::string::npos) return raw;
    return nlohmann::json::parse(text_.substr(begin, end - begin)).get<std::string>();
  }

  const std::string& text_;
  size_t at_ = 0;
};

const JsonMemberSpan* findMember(const JsonSpan& object, const std::string& key) {
  const auto found = std::find_if(object.members.begin(), object.members.end(),
                                  [&](const JsonMemberSpan& member) { return member.key == key; });
  return found == object.members.end() ? nullptr : &*found;
}

/// Bytes from the beginning of its line.
size_t columnOf(const std::string& text, size_t at) {
  const size_t before = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
  return before == std::string::npos ? at : at - before - 1;
}

/// What stands between two members of this object, which has at least one.
std::string separator(const std::string& json, const JsonSpan& object, size_t lengthOfNew) {
  const std::vector<JsonMemberSpan>& members = object.members;
  const JsonMemberSpan& last = members.back();
  std::string between = ", ";
  if (members.size() > 1) {
    const size_t from = members[members.size() - 2].value.end;
    between = json.substr(from, last.begin - from);
  } else if (const std::string lead = json.substr(object.begin + 1, last.begin - object.begin - 1);
             lead.find('\n') != std::string::npos) {
    between = "," + lead;
  }
  const bool breaks = between.find('\n') != std::string::npos;
  if (breaks || columnOf(json, last.value.end) + between.size() + lengthOfNew <= kLongestLine) return between;
  return ",\n" + std::string(columnOf(json, members.front().begin), ' ');
}

}  // namespace

JsonSpan spanOf(const std::string& json) {
  return Scanner(json).root();
}

const JsonSpan* findSpan(const JsonSpan& root, const JsonPath& path) {
  const JsonSpan* at = &root;
  for (const std::string& key : path) {
    const JsonMemberSpan* member = findMember(*at, key);
    if (!member) return nullptr;
    at = &member->value;
  }
  return at;
}

std::string_view valueText(const std::string& json, const JsonPath& path) {
  const JsonSpan root = spanOf(json);
  const JsonSpan* span = findSpan(root, path);
  return span ? std::string_view(json).substr(span->begin, span->end - span->begin) : std::string_view();
}

std::string quoted(const std::string& text) {
  try {
    return nlohmann::json(text).dump();
  } catch (const nlohmann::json::exception&) {
    throw InputError("the text is not valid UTF-8");
  }
}

std::string withMember(const std::string& json, const JsonPath& object, const std::string& key,
                       const std::string& value) {
  const JsonSpan root = spanOf(json);
  const JsonSpan* span = findSpan(root, object);
  if (!span) throw std::logic_error("a member for an object that is not there");
  std::string text = json;
  if (const JsonMemberSpan* member = findMember(*span, key))
    return text.replace(member->value.begin, member->value.end - member->value.begin, value);
  const std::string entry = quoted(key) + ": " + value;
  if (span->members.empty()) return text.replace(span->begin, span->end - span->begin, "{ " + entry + " }");
  return text.insert(span->members.back().value.end, separator(json, *span, entry.size()) + entry);
}

std::string withoutMember(const std::string& json, const JsonPath& object, const std::string& key) {
  const JsonSpan root = spanOf(json);
  const JsonSpan* span = findSpan(root, object);
  const JsonMemberSpan* member = span ? findMember(*span, key) : nullptr;
  if (!member) return json;
  const auto index = static_cast<size_t>(member - span->members.data());
  std::string text = json;
  if (span->members.size() == 1) return text.replace(span->begin, span->end - span->begin, "{}");
  if (index == 0) return text.erase(member->begin, span->members[1].begin - member->begin);
  const size_t before = span->members[index - 1].value.end;
  return text.erase(before, member->value.end - before);
}

}  // namespace weir::view
