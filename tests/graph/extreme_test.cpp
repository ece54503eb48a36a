// Files that nobody writes by hand: very large, very deep, full of faults. All end with a plan or with diagnostics, in
// time that grows with the file and not faster; more passes than are taken are checked all the same. The bound is
// generous, for machines that do other work besides and for sanitizers; what grows faster than the file takes minutes
// here.
#include "fakes.h"

#include <weir/graph/json_tree.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

namespace weir::graph::test {
namespace {

constexpr int kMany = 100'000;
constexpr int kMost = kMostPasses;
constexpr double kSeconds = 20;

class Extreme : public ::testing::Test {
 protected:
  Extreme() {
    PassDescription& link = fakes.add("t.Link");
    link.input("a", storageImage(Format::R32F)).optional();
    link.input("b", storageImage(Format::R32F)).optional();
    link.output("o", storageImage(Format::R32F)).passesThrough("a");
    link.output("p", storageImage(Format::R32F)).passesThrough("b");
    link.param("n", 1).range(0, 10);
    PassDescription& count = fakes.add("t.Count");
    count.input("in", buffer("Reservoir")).anyCount();
    count.output("like", buffer("Reservoir")).countOf("in");
    fakes.add("t.Source").output("o", buffer("Reservoir"));
    fakes.check();
  }

  /// Passes "p0", "p1", …, each with what `body` makes of its number.
  template <typename Body>
  static std::string graphOf(int passes, const std::string& outputs, const Body& body) {
    std::string text = "{\"version\": 1, \"passes\": {";
    for (int i = 0; i < passes; ++i) text += fmt::format("{}\n\"p{}\": {{{}}}", i > 0 ? "," : "", i, body(i));
    return text + "},\n\"outputs\": {" + outputs + "}}";
  }
  static std::string link(const std::string& inputs, const std::string& more = "") {
    return "\"type\": \"t.Link\", \"inputs\": {" + inputs + "}" + more;
  }
  static std::string from(int pass, const char* input = "a", const char* port = "o") {
    return fmt::format("\"{}\": \"p{}.{}\"", input, pass, port);
  }

  Result timed(const std::string& json, const Overrides& overrides = {}) {
    const auto start = std::chrono::steady_clock::now();
    Result result = run(json, fakes, overrides, 8, 8);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    EXPECT_LT(took.count(), kSeconds);
    for (const Diagnostic& d : result.diagnostics) {
      EXPECT_FALSE(d.message.empty());
      if (d.message.empty()) break;
    }
    return result;
  }
  /// What is said of a graph, apart from there being too many passes.
  std::vector<Diagnostic> said(const std::string& json) {
    std::vector<Diagnostic> all = timed(json).diagnostics;
    const auto isLimit = [](const Diagnostic& d) {
      return d.message == "there are 100000 passes; expected at most 4096";
    };
    const auto limit = std::find_if(all.begin(), all.end(), isLimit);
    EXPECT_NE(limit, all.end());
    if (limit != all.end()) {
      EXPECT_EQ(limit->path, "passes");
      EXPECT_EQ(limit->line, kMost + 2);
      all.erase(limit);
    }
    return all;
  }
  /// A graph of the most passes there may be, which has a plan; `make` makes one of so many. Far more give no other
  /// finding than that.
  template <typename Make>
  Result fine(const Make& make) {
    EXPECT_TRUE(said(make(kMany)).empty());
    Result result = timed(make(kMost));
    EXPECT_TRUE(result.diagnostics.empty()) << result.diagnostics.front().text();
    return result;
  }

  Fakes fakes;
};

TEST_F(Extreme, ALongChain) {
  const Result r = fine([](int passes) {
    return graphOf(passes, "\"x\": \"p0.o\"", [&](int i) { return link(i + 1 < passes ? from(i + 1) : ""); });
  });
  ASSERT_EQ(r.graph.passes.size(), size_t{kMost});
  EXPECT_EQ(r.graph.passes.front().name, fmt::format("p{}", kMost - 1));
  EXPECT_EQ(r.graph.passes.back().name, "p0");
}

TEST_F(Extreme, EverybodyReadsOne) {
  const Result r = fine([](int passes) {
    return graphOf(passes, "\"x\": \"p1.o\"",
                   [](int i) { return link(i > 0 ? from(0) + ", " + from(0, "b", "p@previous") : ""); });
  });
  EXPECT_EQ(r.graph.passes.size(), 2u);
  EXPECT_EQ(r.graph.skipped.size(), size_t{kMost - 2});
}

TEST_F(Extreme, NobodyReadsALongChain) {
  const Result r = fine([](int passes) {
    return graphOf(passes, "\"x\": \"p0.o\"",
                   [](int i) { return link(i > 1 ? from(i - 1) + ", " + from(1, "b") : ""); });
  });
  EXPECT_EQ(r.graph.passes.size(), 1u);
  ASSERT_EQ(r.graph.skipped.size(), size_t{kMost - 1});
  EXPECT_NE(r.graph.skipped.front().reason.find("only p10, p100, p1000"), std::string::npos)
      << r.graph.skipped.front().reason.substr(0, 300);
}

TEST_F(Extreme, ALongChainOfDisabledPassesReadAllAlong) {
  // Passes of even numbers are disabled and stand for each other, down to the first; each is read by the next.
  const auto graph = [](int passes, const std::string& first) {
    return graphOf(passes, fmt::format("\"x\": \"p{}.o\"", passes - 1), [&](int i) {
      if (i == 0) return link("", first);
      if (i % 2 == 0) return link(from(i - 2), ", \"enabled\": false");
      return link(from(i - 1) + (i > 1 ? ", " + from(i - 2, "b") : ""));
    });
  };
  const Result r = fine([&](int passes) { return graph(passes, ""); });
  EXPECT_EQ(r.graph.passes.size(), size_t{kMost / 2 + 1});
  EXPECT_EQ(r.source(fmt::format("p{}", kMost - 1), "a"), "p0.o");
  // The same, with a first one that stands aside for nothing: said once, not once a reader.
  const std::vector<Diagnostic> refused = said(graph(kMany, ", \"enabled\": false"));
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_EQ(refused[0].path, "passes.p0.enabled");
}

TEST_F(Extreme, ACountThroughALongChain) {
  const Result r = fine([](int passes) {
    return graphOf(passes, "\"x\": \"p0.like\"", [&](int i) -> std::string {
      if (i + 1 == passes) return "\"type\": \"t.Source\"";
      return fmt::format("\"type\": \"t.Count\", \"inputs\": {{\"in\": \"p{}.{}\"}}", i + 1,
                         i + 2 == passes ? "o" : "like");
    });
  });
  EXPECT_EQ(r.resource("p0.like").perPixel, 1u);
}

TEST_F(Extreme, OneCycleOfAllPasses) {
  const std::vector<Diagnostic> found =
      said(graphOf(kMany, "\"x\": \"p0.o\"", [](int i) { return link(from((i + kMany - 1) % kMany)); }));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].path, "passes.p0.inputs.a") << "the one that reads what comes later in the file";
}

TEST_F(Extreme, VeryManyCycles) {
  EXPECT_EQ(said(graphOf(kMany, "\"x\": \"p0.o\"", [](int i) { return link(from(i ^ 1)); })).size(), size_t{kMany / 2});
  const Result tangle = timed(graphOf(kMany, "\"x\": \"p0.o\"", [](int i) {
    return link(from(static_cast<int>((i * 48271ll + 11) % kMany)) + ", " +
                from(static_cast<int>((i * 69621ll + 7) % kMany), "b"));
  }));
  EXPECT_GE(tangle.diagnostics.size(), 1u);
  EXPECT_NE(tangle.text().find("very many cycles"), std::string::npos);
}

TEST_F(Extreme, EverythingIsWrong) {
  const Result r = timed(graphOf(kMany, "\"x\": \"p0.o\"", [](int i) {
    return fmt::format("\"type\": \"t.Lnk{}\", \"inputs\": {{\"a\": \"q{}.o\"}}, \"bad{}\": 1", i, i, i);
  }));
  EXPECT_EQ(r.diagnostics.size(), size_t{3 * kMany + 1}) << "each is said";
  const Result ports = timed(graphOf(1, "\"x\": \"p0.o\"", [](int) {
    std::string inputs, params;
    for (int i = 0; i < kMany; ++i) {
      inputs += fmt::format("{}\"zz{}\": \"p{}.x\"", i > 0 ? ", " : "", i, i);
      params += fmt::format("{}\"zz{}\": {}", i > 0 ? ", " : "", i, i);
    }
    return link(inputs, ", \"params\": {" + params + "}");
  }));
  EXPECT_GE(ports.diagnostics.size(), size_t{3 * kMany});
}

TEST_F(Extreme, RepeatedKeys) {
  std::string text = "{\"version\": 1, \"passes\": {";
  for (int i = 0; i < kMany; ++i) text += "\"p\": {\"type\": \"t.Link\"},\n";
  const Result r = timed(text + "\"q\": {\"type\": \"t.Link\"}}, \"outputs\": {\"x\": \"p.o\"}}");
  EXPECT_EQ(r.diagnostics.size(), size_t{kMany - 1});
}

TEST_F(Extreme, LongTexts) {
  const std::string mega(10'000'000, 'x');
  const auto one = [&](const std::string& json, const std::string& words) {
    const Result r = timed(json);
    ASSERT_EQ(r.diagnostics.size(), 1u);
    EXPECT_NE(r.text().find(words), std::string::npos) << r.text().substr(0, 500);
    EXPECT_LT(r.text().size(), 1000u);
  };
  one("{\"" + mega + "\": 1}", "a key of 10000000 bytes");
  one("{\"name\": \"" + mega + "\"}", "a text of 10000000 bytes");
  one("{\"name\": \"" + mega + "\xff\"}", "ill-formed UTF-8");
  one("{\"name\": \"" + mega, "missing closing quote");
  one("{\"version\": " + std::string(1'000'000, '9') + "e" + std::string(1000, '9') + "}", "too large");
  one("{\"version\": " + mega + "}", "invalid literal");
  const std::string brackets(5'000'000, '[');
  one("{\"version\": " + brackets, "64");
  // The longest that are taken: they are said, whole.
  const std::string key(kLongestKey, 'k');
  const Result r = timed("{\"version\": 1, \"passes\": {\"" + key +
                         "\": {\"type\": \"t.Link\"}}, \"outputs\": {\"x\": \"" + key.substr(1) + ".o\"}}");
  ASSERT_EQ(r.diagnostics.size(), 1u);
  EXPECT_EQ(r.diagnostics[0].nearest, key);
}

TEST_F(Extreme, NumbersAtTheirEnds) {
  for (const char* number : {"1e308", "-1e308", "1e-400", "9223372036854775808", "-9223372036854775809", "2147483648",
                             "-0.0", "1.0000000000000000000000000000000000000000000001e3"}) {
    const Result r = timed(graphOf(1, "\"x\": \"p0.o\"",
                                   [&](int) { return link("", fmt::format(", \"params\": {{\"n\": {}}}", number)); }));
    EXPECT_LE(r.diagnostics.size(), 1u) << number;
    const Result set =
        timed(graphOf(1, "\"x\": \"p0.o\"", [](int) { return link(""); }), {{fmt::format("p0.n={}", number)}, {}, {}});
    EXPECT_EQ(set.diagnostics.size(), r.diagnostics.size()) << number << ": the command line and the file differ\n"
                                                            << set.text();
  }
  for (const char* number : {"NaN", "nan", "Infinity", "-inf", "0x10", "1e", "--1", "1e999", "\xff\xfe", ""}) {
    const Result r =
        timed(graphOf(1, "\"x\": \"p0.o\"", [](int) { return link(""); }), {{fmt::format("p0.n={}", number)}, {}, {}});
    ASSERT_EQ(r.diagnostics.size(), 1u) << number;
    EXPECT_EQ(r.diagnostics[0].file, "--set");
  }
}

TEST_F(Extreme, VeryManyOverrides) {
  Overrides o;
  for (int i = 0; i < 2'000; ++i) {
    o.set.push_back(fmt::format("p{}.n=3", i));
    o.set.push_back(fmt::format("q{}.n=3", i));
    o.disable.push_back(fmt::format("r{}", i));
    o.enable.push_back(fmt::format("p{}", i));
  }
  const Result r = timed(graphOf(2'000, "\"x\": \"p0.o\"", [](int) { return link(""); }), o);
  EXPECT_EQ(r.diagnostics.size(), 4'000u);
}

}  // namespace
}  // namespace weir::graph::test
