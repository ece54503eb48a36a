// Random damage to a valid file: always a graph or diagnostics, never a crash, and every diagnostic has a message.
#include "fakes.h"

#include <weir/graph/schema.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <random>

namespace weir::graph::test {
namespace {

std::string damaged(const std::string& valid, std::mt19937& random) {
  static const std::vector<std::string> kPieces = {"{",
                                                   "}",
                                                   "[",
                                                   "]",
                                                   ",",
                                                   ":",
                                                   "\"",
                                                   "\\",
                                                   "\\u12",
                                                   "\xff",
                                                   "\n",
                                                   "null",
                                                   "-1",
                                                   "1e999",
                                                   "@previous",
                                                   "1.5",
                                                   "true",
                                                   "@",
                                                   ".",
                                                   "\"x\"",
                                                   "\"a\": ",
                                                   "{\"a\":",
                                                   "/*",
                                                   std::string(1, '\0'),
                                                   "1e9",
                                                   "spatial",
                                                   "gbuffer.surface",
                                                   "\"enabled\": false,",
                                                   "\"params\": {},",
                                                   "temporal.reservoirs"};
  std::string text = valid;
  const int changes = 1 + static_cast<int>(random() % 4);
  for (int i = 0; i < changes && !text.empty(); ++i) {
    const size_t at = random() % text.size();
    const size_t length = random() % std::min<size_t>(text.size() - at, 1 + random() % 40) + 1;
    switch (random() % 6) {
      case 0:
        text.erase(at, length);
        break;
      case 1:
        text.insert(at, kPieces[random() % kPieces.size()]);
        break;
      case 2:
        text.replace(at, length, kPieces[random() % kPieces.size()]);
        break;
      case 3:
        text[at] = static_cast<char>(random());
        break;
      case 4:
        text.insert(random() % text.size(), text.substr(at, length));
        break;
      case 5: {  // swap two words: references and names stay well-formed more often
        const size_t other = random() % text.size();
        std::swap(text[at], text[other]);
        break;
      }
    }
  }
  return text;
}

TEST(Fuzz, DamagedFilesGiveAGraphOrDiagnostics) {
  const Fakes fakes = exampleFakes();
  const std::string valid = readFixture("restir_di.json");
  std::mt19937 random(4711);
  int fine = 0;
  for (int i = 0; i < 20'000; ++i) {
    const std::string text = damaged(valid, random);
    const Result r = run(text, fakes);
    if (r.diagnostics.empty()) {
      ++fine;
      ASSERT_FALSE(r.graph.passes.empty()) << text;
      ASSERT_FALSE(explain(r.graph).empty());
    }
    for (const Diagnostic& d : r.diagnostics) {
      ASSERT_FALSE(d.message.empty()) << text;
      ASSERT_GE(d.line, 1) << d.text() << "\n" << text;
    }
  }
  EXPECT_GT(fine, 10) << "some damage does no harm";
}

TEST(Fuzz, DamagedOverrides) {
  const Fakes fakes = exampleFakes();
  const std::string valid = readFixture("restir_di.json");
  std::mt19937 random(11);
  int refused = 0;
  for (int i = 0; i < 2'000; ++i) {
    Overrides o;
    const int which = static_cast<int>(random() % 3);
    if (which == 0) o.set = {"spatial.radius=20", damaged("spatial.radius=12.5", random)};
    if (which == 1) o.enable = {"temporal", damaged("spatial", random)};
    if (which == 2) o.disable = {"temporal", damaged("spatial", random)};
    const Result r = run(valid, fakes, o);
    for (const Diagnostic& d : r.diagnostics) {
      ASSERT_FALSE(d.message.empty());
      ASSERT_EQ(d.file.substr(0, 2), "--") << d.text() << ": the file itself has no faults";
    }
    refused += r.diagnostics.empty() ? 0 : 1;
  }
  EXPECT_GT(refused, 1'000);
  EXPECT_LT(refused, 2'000) << "some damage does no harm";
}

TEST(Schema, IsJsonAndNamesEveryType) {
  const Fakes fakes = exampleFakes();
  const nlohmann::json schema = nlohmann::json::parse(schemaJson(fakes.catalog()));
  const auto& spatial = schema.at("definitions").at("restir_di.Spatial").at("properties");
  EXPECT_EQ(spatial.at("params").at("properties").at("radius").at("maximum"), 200);
  EXPECT_EQ(spatial.at("params").at("properties").at("iterations").at("type"), "integer");
  EXPECT_EQ(schema.at("definitions")
                .at("restir_di.Temporal")
                .at("properties")
                .at("params")
                .at("properties")
                .at("mis")
                .at("enum")
                .size(),
            4u);
  const auto& pass = schema.at("definitions").at("pass");
  EXPECT_EQ(pass.at("properties").at("type").at("enum").size(), 7u);
  EXPECT_EQ(pass.at("allOf").size(), 7u);
  EXPECT_EQ(spatial.at("params").at("properties").at("radius").at("description"),
            "Number from 1 to 200, default 30, in pixels.");
  EXPECT_EQ(spatial.at("inputs").at("properties").at("reservoirs").at("description"), "Required; Reservoir v1.");
  EXPECT_NO_THROW(nlohmann::json::parse(schemaJson(Fakes().catalog())));
}

}  // namespace
}  // namespace weir::graph::test
