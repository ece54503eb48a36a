// Edits of JSON's text against the same edits of a parsed document, by another library's own means.
#include "view/document/json_text.h"

#include <weir/core/error.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <random>

#include "graphs.h"

namespace weir::view::test {
namespace {

using Json = nlohmann::ordered_json;

/// JSON of all kinds of layout: keys with escapes, brackets in texts, arrays, empty objects, spaces and line breaks.
class Writer {
 public:
  explicit Writer(unsigned seed) : random_(seed) {}

  std::string object(int depth) {
    std::string text = "{" + space();
    const int members = pick(5);
    for (int i = 0; i < members; ++i) {
      if (i > 0) text += space() + "," + space();
      text += key(i) + space() + ":" + space() + value(depth - 1);
    }
    return text + space() + "}";
  }
  int pick(int below) { return static_cast<int>(random_() % static_cast<unsigned>(below)); }

 private:
  std::string space() {
    constexpr const char* kSpaces[] = {"", " ", "\n  ", "\t", "  \r\n"};
    return kSpaces[pick(5)];
  }
  std::string key(int i) {
    constexpr const char* kKeys[] = {"\"a\"", "\"\\\"b}\"", "\"c\\\\\"", "\"\\u00e4\"", "\"e,\""};
    return kKeys[i];
  }
  std::string value(int depth) {
    switch (pick(depth > 0 ? 7 : 5)) {
      case 0:
        return "-1.50e+03";
      case 1:
        return "\"{\\\"},[\\\\\"";
      case 2:
        return "true";
      case 3:
        return "[" + space() + "1," + space() + "{ \"x\": [] }, \"]\"" + space() + "]";
      case 4:
        return "{}";
      default:
        return object(depth);
    }
  }
  std::mt19937 random_;
};

/// Some object in the document, by the keys that lead to it.
JsonPath someObject(const Json& root, Writer& writer) {
  JsonPath path;
  for (const Json* at = &root; writer.pick(3) != 0;) {
    std::vector<std::string> inner;
    for (const auto& [key, value] : at->items())
      if (value.is_object()) inner.push_back(key);
    if (inner.empty()) break;
    path.push_back(inner[static_cast<size_t>(writer.pick(static_cast<int>(inner.size())))]);
    at = &at->at(path.back());
  }
  return path;
}

Json& at(Json& root, const JsonPath& path) {
  Json* here = &root;
  for (const std::string& key : path) here = &here->at(key);
  return *here;
}

/// What two texts have in common at their ends is all but one stretch.
void expectOneStretch(const std::string& before, const std::string& after, size_t most) {
  size_t front = 0, back = 0;
  const size_t shorter = std::min(before.size(), after.size());
  while (front < shorter && before[front] == after[front]) ++front;
  while (back < shorter - front && before[before.size() - 1 - back] == after[after.size() - 1 - back]) ++back;
  EXPECT_LE(before.size() - front - back, most) << before << "\nbecame\n" << after;
}

TEST(JsonText, EditsMeanWhatTheyMeanInAParsedDocument) {
  for (unsigned seed = 0; seed < 2000; ++seed) {
    Writer writer(seed);
    std::string text = (seed % 7 == 0 ? "\xef\xbb\xbf" : "") + writer.object(4);
    Json model = Json::parse(text);
    for (int edit = 0; edit < 6; ++edit) {
      const JsonPath path = someObject(model, writer);
      const JsonSpan root = spanOf(text);
      const JsonSpan* span = findSpan(root, path);
      ASSERT_NE(span, nullptr);
      const std::string key = writer.pick(2) == 0 ? "new \"one\"" : "a";
      Json& object = at(model, path);
      const std::string before = text;
      if (writer.pick(3) > 0) {
        const size_t old = object.contains(key) ? std::string(valueText(text,
                                                                        [&] {
                                                                          JsonPath whole = path;
                                                                          whole.push_back(key);
                                                                          return whole;
                                                                        }()))
                                                      .size()
                                                : 0;
        text = withMember(text, path, key, "[7, {}]");
        object[key] = Json::array({7, Json::object()});
        expectOneStretch(before, text, std::max(old, object.size() == 1 ? span->end - span->begin : 0));
      } else {
        text = withoutMember(text, path, key);
        object.erase(key);
      }
      ASSERT_EQ(Json::parse(text).dump(), model.dump()) << "seed " << seed << ": " << before << "\nbecame\n" << text;
    }
  }
}

TEST(JsonText, ANewMemberIsLaidOutAsTheOthersAre) {
  EXPECT_EQ(withMember("{ \"a\": 1 }", {}, "b", "2"), "{ \"a\": 1, \"b\": 2 }");
  EXPECT_EQ(withMember("{\n  \"a\": 1\n}\n", {}, "b", "2"), "{\n  \"a\": 1,\n  \"b\": 2\n}\n");
  EXPECT_EQ(withMember("{\"a\":1,\"b\":2}", {}, "c", "3"), "{\"a\":1,\"b\":2,\"c\": 3}");
  EXPECT_EQ(withMember("{}", {}, "b", "2"), "{ \"b\": 2 }");
  const std::string wide = "  { \"" + std::string(110, 'k') + "\": 1 }";
  EXPECT_EQ(withMember(wide, {}, "b", "2"), replaced(wide, ": 1", ": 1,\n    \"b\": 2"));
}

TEST(JsonText, TakingAwayWhatWasAddedGivesTheTextBack) {
  for (const char* text :
       {"{ \"a\": 1 }", "{\n  \"a\": 1\n}\n", "{\"a\":1 , \"b\":2}", "{\n \"a\": 1, \"c\": 2,\n \"d\": {}}"})
    EXPECT_EQ(withoutMember(withMember(text, {}, "new", "[]"), {}, "new"), text);
}

TEST(JsonText, QuotesWhatJsonWantsQuoted) {
  EXPECT_EQ(quoted("a\"\\\n"), "\"a\\\"\\\\\\n\"");
  EXPECT_THROW(quoted("\xff"), InputError);
}

}  // namespace
}  // namespace weir::view::test
