// Structure and lines: what parse() says before any pass is known.
#include <weir/graph/description.h>

#include <gtest/gtest.h>

#include <string>

namespace weir::graph {
namespace {

struct Parsed {
  Description d;
  std::vector<Diagnostic> diagnostics;
  explicit Parsed(const std::string& json) { d = parse(json, "g.json", diagnostics); }
  std::string text() const {
    std::string all;
    for (const Diagnostic& diagnostic : diagnostics) all += diagnostic.text() + "\n";
    return all;
  }
  /// The only diagnostic.
  Diagnostic only() const {
    EXPECT_EQ(diagnostics.size(), 1u) << text();
    return diagnostics.empty() ? Diagnostic{} : diagnostics.front();
  }
};

std::string graphWith(const std::string& pass) {
  return "{\"version\": 1, \"passes\": {\"a\": " + pass + "}, \"outputs\": {\"o\": \"a.x\"}}";
}

TEST(Parse, EveryValueHasItsLine) {
  const Parsed p(
      "{\n"                                           // 1
      "  \"version\"\n"                               // 2
      "  :\n"                                         // 3
      "  1\n"                                         // 4
      ", \"passes\": {\n"                             // 5
      "    \"a\"\n"                                   // 6
      "    : { \"type\":\n"                           // 7
      "      \"p.A\",\n"                              // 8
      "      \"enabled\":\n"                          // 9
      "      false, \"inputs\": { \"x\":\n"           // 10
      "\n"                                            // 11
      "        \"b.y@previous\" },\n"                 // 12
      "      \"params\": { \"n\": 3\n"                // 13
      "      , \"f\":\n"                              // 14
      "        -2.5e3\n"                              // 15
      "      , \"t\": true, \"s\":\"\\n\\u00e9\"}\n"  // 16
      "    }},\n"                                     // 17
      "  \"outputs\": { \"o\"\n"                      // 18
      "   :\"a.z\"}}\n");                             // 19
  EXPECT_EQ(p.text(), "");
  ASSERT_EQ(p.d.passes.size(), 1u);
  const PassEntry& a = p.d.passes[0];
  EXPECT_EQ(a.line, 6);
  EXPECT_EQ(a.typeLine, 8);
  EXPECT_EQ(a.enabledLine, 10);
  EXPECT_FALSE(a.enabled);
  ASSERT_EQ(a.inputs.size(), 1u);
  EXPECT_EQ(a.inputs[0].nameLine, 10);
  EXPECT_EQ(a.inputs[0].line, 12);
  EXPECT_TRUE(a.inputs[0].source->previous);
  ASSERT_EQ(a.params.size(), 4u);
  EXPECT_EQ(a.params[0].line, 13);
  EXPECT_EQ(std::get<int64_t>(a.params[0].value), 3);
  EXPECT_EQ(a.params[1].nameLine, 14);
  EXPECT_EQ(a.params[1].line, 15);
  EXPECT_EQ(std::get<double>(a.params[1].value), -2500.0);
  EXPECT_EQ(a.params[2].line, 16);
  EXPECT_EQ(std::get<bool>(a.params[2].value), true);
  EXPECT_EQ(std::get<std::string>(a.params[3].value), "\n\u00e9");
  EXPECT_EQ(p.d.outputs.at(0).line, 19);
}

TEST(Parse, LinesEndingInCarriageReturnsCountOnce) {
  const Parsed p("{\r\n\"version\": 1,\r\n\"passes\": {\"a\": {\"type\": \"p.A\"}},\r\n\"outputs\": {\"o\": 3}}");
  EXPECT_EQ(p.only().line, 4);
  EXPECT_EQ(p.only().path, "outputs.o");
}

TEST(Parse, ANumberBeforeALineBreakKeepsItsLine) {
  const Parsed p("{\"version\":\n2\n,\"passes\": {\"a\": {\"type\": \"p.A\"}}, \"outputs\": {\"o\": \"a.x\"}}");
  EXPECT_EQ(p.only().line, 2);
  EXPECT_EQ(p.only().path, "version");
}

TEST(Parse, AByteOrderMarkIsSkipped) {
  EXPECT_EQ(Parsed("\xEF\xBB\xBF" + graphWith("{\"type\": \"p.A\"}")).text(), "");
}

TEST(Parse, RepeatedKeysAreErrorsOnEveryLevel) {
  const Parsed p(
      "{\"version\": 1,\n\"version\": 1,\n\"passes\": {\"a\": {\"type\": \"p.A\",\n\"type\": \"p.B\", \"params\": "
      "{\"n\": 1,\n"
      "\"n\": 2}},\n\"a\": {}}, \"outputs\": {\"o\": \"a.x\"}}");
  ASSERT_EQ(p.diagnostics.size(), 4u) << p.text();
  const int lines[] = {2, 4, 5, 6};
  const char* paths[] = {"version", "passes.a.type", "passes.a.params.n", "passes.a"};
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(p.diagnostics[i].line, lines[i]);
    EXPECT_EQ(p.diagnostics[i].path, paths[i]);
    EXPECT_NE(p.diagnostics[i].message.find("repeated"), std::string::npos);
  }
  EXPECT_EQ(p.d.passes.at(0).type, "p.A") << "the first one counts";
}

TEST(Parse, BrokenJsonIsOneDiagnosticWithItsLine) {
  const struct {
    const char* json;
    int line;
  } cases[] = {{"", 1},
               {"{\n\"version\": 1,\n}", 3},
               {"{\n\"version\": NaN}", 2},
               {"{\n\"version\": Infinity}", 2},
               {"{\n\n\"version\": 1e999}", 3},
               {"{\"version\": 1\n", 1},
               {"{\"name\": \"a\nb\"}", 1},
               {"{\"name\": \"\xff\"}", 1},
               {"// comment\n{}", 1},
               {"{\"version\": 1} x", 1},
               {"\xFE\xFF{}", 1}};
  for (const auto& c : cases) {
    const Parsed p(c.json);
    ASSERT_EQ(p.diagnostics.size(), 1u) << c.json << "\n" << p.text();
    EXPECT_EQ(p.diagnostics[0].line, c.line) << c.json << "\n" << p.text();
    EXPECT_NE(p.diagnostics[0].message.find("not valid JSON"), std::string::npos) << p.text();
    EXPECT_EQ(p.diagnostics[0].message.find("json.exception"), std::string::npos) << p.text();
    EXPECT_TRUE(p.d.broken);
  }
  EXPECT_NE(Parsed("{\"version\": 1e999}").text().find("1e999"), std::string::npos);
}

TEST(Parse, DeepNestingIsRefusedWithoutRecursion) {
  for (const char* bracket : {"[", "{\"a\":"}) {
    std::string json;
    for (int i = 0; i < 100'000; ++i) json += bracket;
    EXPECT_NE(Parsed(json).only().message.find("64"), std::string::npos);
  }
}

TEST(Parse, HugeIntegersAreNumbers) {
  const Parsed p(
      graphWith("{\"type\": \"p.A\", \"params\": {\"n\": 18446744073709551615, \"m\": 123456789012345678901}}"));
  EXPECT_EQ(p.text(), "");
  EXPECT_EQ(std::get<double>(p.d.passes[0].params[0].value), 18446744073709551615.0);
}

TEST(Parse, UnknownKeysNameTheNearest) {
  const Parsed p(
      "{\"version\": 1, \"nmae\": \"x\",\n\"passes\": {\"a\": {\"type\": \"p.A\",\n\"enabld\": true}}, "
      "\"outputs\": {\"o\": \"a.x\"}}");
  ASSERT_EQ(p.diagnostics.size(), 2u) << p.text();
  EXPECT_EQ(p.diagnostics[0].nearest, "name");
  EXPECT_EQ(p.diagnostics[0].line, 1);
  EXPECT_EQ(p.diagnostics[1].nearest, "enabled");
  EXPECT_EQ(p.diagnostics[1].path, "passes.a.enabld");
  EXPECT_EQ(p.diagnostics[1].line, 3);
}

TEST(Parse, AMisspeltKeyIsOneFindingAndItsValueIsRead) {
  const Parsed p(
      "{\"version\": 1, \"pases\": {\"a\": {\"tpye\": \"p.A\", \"input\": {\"x\": \"b.y\"}}}, "
      "\"output\": {\"o\": \"a.x\"}}");
  EXPECT_EQ(p.diagnostics.size(), 4u) << p.text();
  ASSERT_EQ(p.d.passes.size(), 1u);
  EXPECT_EQ(p.d.passes[0].type, "p.A");
  EXPECT_EQ(p.d.passes[0].inputs.size(), 1u);
  EXPECT_EQ(p.d.outputs.size(), 1u);
}

TEST(Parse, SchemaAndDescriptionAreAllowed) {
  EXPECT_EQ(
      Parsed("{\"$schema\": \"x\", \"description\": \"y\", \"version\": 1, \"passes\": {\"a\": {\"type\": \"p.A\"}}, "
             "\"outputs\": {\"o\": \"a.x\"}}")
          .text(),
      "");
}

TEST(Parse, MissingAndWrongKinds) {
  const auto says = [](const std::string& json, const std::string& path, const std::string& words) {
    const Parsed p(json);
    for (const Diagnostic& diagnostic : p.diagnostics)
      if (diagnostic.path == path && diagnostic.message.find(words) != std::string::npos) return;
    ADD_FAILURE() << json << "\nshould say '" << words << "' at '" << path << "', but said\n" << p.text();
  };
  says("[]", "", "must be a JSON object, not an array");
  says("3", "", "not an integer");
  says("{}", "version", "missing");
  says("{}", "passes", "missing");
  says("{}", "outputs", "missing");
  says("{\"version\": \"1\"}", "version", "expected 1");
  says("{\"version\": 2}", "version", "not 2");
  says("{\"name\": 3}", "name", "expected a text, not an integer");
  says("{\"passes\": []}", "passes", "expected an object, not an array");
  says("{\"passes\": {}}", "passes", "at least one");
  says("{\"outputs\": {}}", "outputs", "at least one");
  says(graphWith("3"), "passes.a", "expected an object");
  says(graphWith("{}"), "passes.a.type", "missing");
  says(graphWith("{\"type\": \"\"}"), "passes.a.type", "empty");
  says(graphWith("{\"type\": \"p.A\", \"enabled\": 1}"), "passes.a.enabled", "expected true or false, not an integer");
  says(graphWith("{\"type\": \"p.A\", \"inputs\": []}"), "passes.a.inputs", "expected an object");
  says(graphWith("{\"type\": \"p.A\", \"inputs\": {\"x\": null}}"), "passes.a.inputs.x", "expected a text, not null");
  says(graphWith("{\"type\": \"p.A\", \"inputs\": {\"x\": \"b\"}}"), "passes.a.inputs.x", "no reference");
  says(graphWith("{\"type\": \"p.A\", \"params\": {\"x\": {}}}"), "passes.a.params.x", "not an object");
  says("{\"passes\": {\"a b\": {\"type\": \"p.A\"}}}", "passes.a b", "can't be a pass's name");
}

TEST(Parse, References) {
  for (const char* good : {"a.b", "a-1.b_2", "a.b@previous"}) EXPECT_TRUE(parseReference(good)) << good;
  for (const char* bad :
       {"", ".", "a", "a.", ".b", "a.b.c", "a.b@prev", "a.b@", "a.b@previous@previous", " a.b", "a.b "})
    EXPECT_FALSE(parseReference(bad)) << bad;
  const Parsed p(graphWith("{\"type\": \"p.A\", \"inputs\": {\"x\": \"b.y@prev\"}}"));
  EXPECT_EQ(p.only().nearest, "b.y@previous");
}

TEST(Parse, AMissingFileIsAnInputError) {
  std::vector<Diagnostic> diagnostics;
  EXPECT_THROW(load("/nowhere/graph.json", diagnostics), InputError);
  EXPECT_THROW(load("/", diagnostics), InputError);
}

}  // namespace
}  // namespace weir::graph
