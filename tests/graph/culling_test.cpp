// Which passes run and why others don't, and ports in all the ways they are connected: left open, read by many, read by
// nobody, smaller than the frame, standing for those of disabled passes.
#include "fakes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <map>
#include <random>
#include <sstream>

namespace weir::graph::test {
namespace {

using Names = std::vector<std::string>;
using Json = nlohmann::ordered_json;

/// A graph of lines "name: Type a=x.o b=y.o@previous", each a pass, and "-name: …" one that is disabled.
std::string graphOf(const Names& lines, const std::map<std::string, std::string>& outputs) {
  Json graph = {{"version", 1}, {"name", "small"}, {"passes", Json::object()}, {"outputs", outputs}};
  for (const std::string& line : lines) {
    std::istringstream words(line);
    std::string name, type, input;
    words >> name >> type;
    name.pop_back();
    const bool disabled = name.starts_with('-');
    if (disabled) name.erase(0, 1);
    Json& pass = graph["passes"][name] = {{"type", "t." + type}};
    if (disabled) pass["enabled"] = false;
    while (words >> input) {
      const size_t equals = input.find('=');
      pass["inputs"][input.substr(0, equals)] = input.substr(equals + 1);
    }
  }
  return graph.dump(1);
}

class Culling : public ::testing::Test {
 protected:
  Culling() {
    const PortType full = storageImage(Format::R32F);
    fakes.add("t.Source").output("o", full);
    fakes.add("t.Many").output("a", full);
    fakes.add("t.Many").output("b", full);
    fakes.add("t.Many").output("c", buffer("Reservoir"));
    fakes.add("t.Filter").input("i", full);
    fakes.add("t.Filter").output("o", full).passesThrough("i");
    fakes.add("t.Mix").input("a", full);
    fakes.add("t.Mix").input("b", full);
    fakes.add("t.Mix").output("o", full).passesThrough("a");
    fakes.add("t.Maybe").input("i", full);
    fakes.add("t.Maybe").input("extra", full).optional();
    fakes.add("t.Maybe").output("o", full);
    fakes.add("t.Half").input("i", full);
    fakes.add("t.Half").output("o", full).scale(1, 2);
    fakes.add("t.Half").output("buffer", buffer("Reservoir")).scale(1, 2);
    fakes.add("t.Quarter").input("i", full).scale(1, 2);
    fakes.add("t.Quarter").output("o", full).scale(1, 4);
    fakes.add("t.ThreeHalves").output("o", full).scale(3, 2);
    fakes.add("t.Join").input("full", full);
    fakes.add("t.Join").input("half", full).scale(1, 2);
    fakes.add("t.Join").input("quarter", full).scale(1, 4);
    fakes.add("t.Join").output("o", full);
    fakes.check();
  }

  Result compile(const Names& passes, const std::map<std::string, std::string>& outputs, uint32_t width = 64,
                 uint32_t height = 32) {
    return run(graphOf(passes, outputs), fakes, {}, width, height);
  }
  Result fine(const Names& passes, const std::map<std::string, std::string>& outputs, uint32_t width = 64,
              uint32_t height = 32) {
    Result r = compile(passes, outputs, width, height);
    EXPECT_EQ(r.text(), "");
    return r;
  }
  static std::map<std::string, std::string> reasons(const Result& r) {
    std::map<std::string, std::string> all;
    for (const Skipped& skipped : r.graph.skipped) all[skipped.pass] = skipped.reason;
    return all;
  }

  Fakes fakes;
};

TEST_F(Culling, EachReason) {
  const Result r = fine(
      {"s: Source", "used: Filter i=s.o", "unread: Filter i=s.o", "chain1: Filter i=s.o", "chain2: Filter i=chain1.o",
       "fork: Filter i=s.o", "left: Filter i=fork.o", "right: Filter i=fork.o@previous", "-off: Filter i=used.o",
       "-gone: Mix a=s.o b=side.o", "side: Filter i=s.o", "last: Mix a=off.o b=gone.o"},
      {{"x", "last.o"}});
  EXPECT_EQ(r.order(), (Names{"s", "used", "last"}));
  const std::map<std::string, std::string> expected = {
      {"unread", "nothing reads it"},
      {"chain1", "no output depends on it: only chain2 reads it, and is skipped too"},
      {"chain2", "nothing reads it"},
      {"fork", "no output depends on it: only left, right read it, and are skipped too"},
      {"left", "nothing reads it"},
      {"right", "nothing reads it"},
      {"off", "it is disabled; used.o stands for its 'o'"},
      {"gone", "it is disabled; s.o stands for its 'o'"},
      {"side", "no output depends on it: only gone reads it, and is skipped too"}};
  EXPECT_EQ(reasons(r), expected);
  EXPECT_FALSE(r.resource("s.o").history);
  EXPECT_THROW(r.resource("fork.o"), std::out_of_range) << "what does not run has no memory";
  const std::string text = explain(r.graph);
  for (const auto& [pass, reason] : expected)
    EXPECT_NE(text.find(pass + ": " + reason), std::string::npos) << pass << " is missing in\n" << text;
}

TEST_F(Culling, ACircleThroughLastFrameThatNobodyReadsIsSkipped) {
  const Result r = fine({"s: Source", "a: Mix a=s.o b=b.o@previous", "b: Filter i=a.o"}, {{"x", "s.o"}});
  EXPECT_EQ(r.order(), Names{"s"});
  EXPECT_EQ(reasons(r)["a"], "no output depends on it: only b reads it, and is skipped too");
  EXPECT_EQ(reasons(r)["b"], "no output depends on it: only a reads it, and is skipped too");
}

TEST_F(Culling, OptionalInputsMayBeOpenAndOthersNot) {
  const Result r =
      fine({"s: Source", "open: Maybe i=s.o", "full: Maybe i=open.o extra=s.o@previous"}, {{"x", "full.o"}});
  EXPECT_EQ(r.source("open", "i"), "s.o");
  EXPECT_EQ(r.source("open", "extra"), "");
  EXPECT_EQ(r.source("full", "extra"), "s.o@previous");
  EXPECT_EQ(r.pass("open").inputs.size(), 2u) << "an open input keeps its place";
  const Result missing = compile({"s: Source", "open: Maybe extra=s.o"}, {{"x", "open.o"}});
  ASSERT_EQ(missing.diagnostics.size(), 1u);
  EXPECT_EQ(missing.diagnostics[0].path, "passes.open.inputs.i");
}

TEST_F(Culling, AnOpenOptionalInputKeepsNobodyAlive) {
  const Result r = fine({"s: Source", "other: Source", "m: Maybe i=s.o"}, {{"x", "m.o"}});
  EXPECT_EQ(reasons(r), (std::map<std::string, std::string>{{"other", "nothing reads it"}}));
}

TEST_F(Culling, OneOutputFeedsMany) {
  const Result r =
      fine({"s: Source", "a: Filter i=s.o", "b: Filter i=s.o", "c: Mix a=s.o b=s.o", "d: Filter i=s.o@previous",
            "ab: Mix a=a.o b=b.o", "cd: Mix a=c.o b=d.o", "z: Mix a=ab.o b=cd.o"},
           {{"x", "z.o"}, {"y", "s.o"}, {"again", "s.o"}});
  const size_t count = static_cast<size_t>(std::count_if(r.graph.resources.begin(), r.graph.resources.end(),
                                                         [](const Resource& x) { return x.name == "s.o"; }));
  EXPECT_EQ(count, 1u) << "one resource, however many read it";
  for (const char* reader : {"a", "b"}) EXPECT_EQ(r.source(reader, "i"), "s.o");
  EXPECT_EQ(r.source("c", "a"), "s.o");
  EXPECT_EQ(r.source("c", "b"), "s.o");
  EXPECT_EQ(r.source("d", "i"), "s.o@previous");
  EXPECT_EQ(r.graph.findOutput("y")->resource, r.graph.findOutput("again")->resource);
}

TEST_F(Culling, APassRunsForOneOfItsOutputs) {
  const Result r = fine({"m: Many", "f: Filter i=m.b"}, {{"x", "f.o"}});
  EXPECT_EQ(r.order(), (Names{"m", "f"}));
  ASSERT_EQ(r.pass("m").outputs.size(), 3u) << "it writes all of them, read or not";
  for (const char* name : {"m.a", "m.b", "m.c"}) EXPECT_GT(r.resource(name).bytes, 0u) << name;
  EXPECT_EQ(r.source("f", "i"), "m.b");
}

TEST_F(Culling, SizesAreSharesOfTheFrameRoundedUp) {
  const struct {
    uint32_t width, height, halfWidth, halfHeight, quarterWidth, quarterHeight, moreWidth, moreHeight;
  } cases[] = {{1, 1, 1, 1, 1, 1, 2, 2},
               {3, 5, 2, 3, 1, 2, 5, 8},
               {4, 8, 2, 4, 1, 2, 6, 12},
               {1919, 1081, 960, 541, 480, 271, 2879, 1622},
               {40000, 40001, 20000, 20001, 10000, 10001, 60000, 60002}};
  for (const auto& c : cases) {
    const Result r = fine(
        {"s: Source", "h: Half i=s.o", "q: Quarter i=h.o", "j: Join full=s.o half=h.o quarter=q.o", "t: ThreeHalves"},
        {{"x", "j.o"}, {"t", "t.o"}}, c.width, c.height);
    const auto expectSize = [&](const char* name, uint32_t width, uint32_t height, uint64_t bytesEach) {
      EXPECT_EQ(r.resource(name).width, width) << name << " at " << c.width << "x" << c.height;
      EXPECT_EQ(r.resource(name).height, height) << name << " at " << c.width << "x" << c.height;
      EXPECT_EQ(r.resource(name).bytes, uint64_t{width} * height * bytesEach) << name;
    };
    expectSize("s.o", c.width, c.height, 4);
    expectSize("h.o", c.halfWidth, c.halfHeight, 4);
    expectSize("h.buffer", c.halfWidth, c.halfHeight, 32);
    EXPECT_EQ(r.resource("h.buffer").elements, uint64_t{c.halfWidth} * c.halfHeight);
    expectSize("q.o", c.quarterWidth, c.quarterHeight, 4);
    expectSize("t.o", c.moreWidth, c.moreHeight, 4);
  }
}

TEST_F(Culling, AMismatchOfScalesSaysBoth) {
  const auto says = [&](const Names& passes, const std::string& expected, const std::string& found) {
    const Result r = compile(passes, {{"x", "j.o"}});
    ASSERT_EQ(r.diagnostics.size(), 1u) << r.text();
    EXPECT_EQ(r.diagnostics[0].path, "passes.j.inputs.half");
    EXPECT_NE(r.text().find("expected image R32F " + expected), std::string::npos) << r.text();
    EXPECT_NE(r.text().find("is image R32F " + found), std::string::npos) << r.text();
  };
  const std::string s = "s: Source", h = "h: Half i=s.o", q = "q: Quarter i=h.o";
  says({s, h, q, "j: Join full=s.o half=q.o quarter=q.o"}, "at 1/2 of the frame's size", "at 1/4 of the frame's size");
  says({s, h, q, "j: Join full=s.o half=s.o quarter=q.o"}, "at 1/2 of the frame's size", "at the frame's size");
  says({s, h, q, "j: Join full=s.o half=q.o@previous quarter=q.o"}, "at 1/2 of the frame's size",
       "at 1/4 of the frame's size");
  // At 1x1 all of them are one pixel; they still don't fit, as they would not at another size.
  EXPECT_EQ(compile({s, h, q, "j: Join full=s.o half=q.o quarter=q.o"}, {{"x", "j.o"}}, 1, 1).diagnostics.size(), 1u);
}

TEST_F(Culling, ScalesAreEqualAsFractions) {
  fakes.add("t.TwoQuarters").output("o", storageImage(Format::R32F)).scale(2, 4);
  const Result r = fine({"s: Source", "h: TwoQuarters", "q: Quarter i=h.o", "j: Join full=s.o half=h.o quarter=q.o"},
                        {{"x", "j.o"}}, 3, 5);
  EXPECT_EQ(r.resource("h.o").width, 2u);
}

TEST_F(Culling, DisabledChains) {
  const Names passes = {"s: Source",
                        "-a: Filter i=s.o",
                        "-b: Mix a=a.o b=s.o",
                        "-c: Filter i=b.o",
                        "now: Filter i=c.o",
                        "past: Filter i=c.o@previous",
                        "z: Mix a=now.o b=past.o"};
  const Result r = fine(passes, {{"x", "z.o"}, {"c", "c.o@previous"}});
  EXPECT_EQ(r.order(), (Names{"past", "s", "now", "z"}));
  EXPECT_EQ(r.source("now", "i"), "s.o");
  EXPECT_EQ(r.source("past", "i"), "s.o@previous");
  EXPECT_TRUE(r.resource("s.o").history);
  EXPECT_TRUE(r.graph.findOutput("c")->previous);
  EXPECT_EQ(r.graph.resources[r.graph.findOutput("c")->resource].name, "s.o");
}

TEST_F(Culling, DisabledDiamonds) {
  //      ┌ a ┐            Both arms stand aside, then the join too: it passes its first input through.
  //   s ─┤   ├─ j ─ z
  //      └ b ┘
  const auto diamond = [](const char* a, const char* b, const char* j) {
    return Names{"s: Source", std::string(a) + ": Filter i=s.o", std::string(b) + ": Filter i=s.o@previous",
                 std::string(j) + ": Mix a=a.o b=b.o", "z: Filter i=j.o"};
  };
  const Result arms = fine(diamond("-a", "-b", "j"), {{"x", "z.o"}});
  EXPECT_EQ(arms.order(), (Names{"s", "j", "z"}));
  EXPECT_EQ(arms.source("j", "a"), "s.o");
  EXPECT_EQ(arms.source("j", "b"), "s.o@previous");
  const Result one = fine(diamond("-a", "b", "-j"), {{"x", "z.o"}});
  EXPECT_EQ(one.order(), (Names{"s", "z"})) << "b is read by the disabled join only";
  EXPECT_EQ(reasons(one)["b"], "no output depends on it: only j reads it, and is skipped too");
  EXPECT_FALSE(one.resource("s.o").history);
  const Result all = fine(diamond("-a", "-b", "-j"), {{"x", "z.o"}});
  EXPECT_EQ(all.source("z", "i"), "s.o");
}

TEST_F(Culling, LastFramesAddUpThroughDisabledPasses) {
  const Names passes = {"s: Source", "-a: Filter i=s.o@previous", "-b: Filter i=a.o", "z: Filter i=b.o"};
  const Result r = fine(passes, {{"x", "z.o"}});
  EXPECT_EQ(r.source("z", "i"), "s.o@previous");
  for (const Names& twice :
       {Names{"s: Source", "-a: Filter i=s.o@previous", "-b: Filter i=a.o", "z: Filter i=b.o@previous"},
        Names{"s: Source", "-a: Filter i=s.o@previous", "-b: Filter i=a.o@previous", "z: Filter i=b.o"}}) {
    const Result bad = compile(twice, {{"x", "z.o"}});
    ASSERT_EQ(bad.diagnostics.size(), 1u) << bad.text();
    EXPECT_EQ(bad.diagnostics[0].path, "passes.z.inputs.i");
    EXPECT_NE(bad.text().find("two frames old"), std::string::npos) << bad.text();
  }
}

TEST_F(Culling, AWayThroughTwoOutputsOfOneDisabledPassIsNoCircle) {
  fakes.add("t.Two").input("a", storageImage(Format::R32F));
  fakes.add("t.Two").input("b", storageImage(Format::R32F));
  fakes.add("t.Two").output("o", storageImage(Format::R32F)).passesThrough("a");
  fakes.add("t.Two").output("p", storageImage(Format::R32F)).passesThrough("b");
  const Result r = fine({"s: Source", "-f: Filter i=t.p", "-t: Two a=f.o b=s.o", "z: Filter i=t.o"}, {{"x", "z.o"}});
  EXPECT_EQ(r.source("z", "i"), "s.o");
  const Result circle =
      compile({"s: Source", "-f: Filter i=t.o", "-t: Two a=f.o b=s.o", "z: Mix a=t.o b=f.o@previous"}, {{"x", "z.o"}});
  ASSERT_EQ(circle.diagnostics.size(), 1u) << circle.text();
  EXPECT_NE(circle.text().find("t → f → t"), std::string::npos) << circle.text();
}

/// Everything that a plan says, as text.
std::string planText(const CompiledGraph& graph) {
  std::string text = explain(graph) + dot(graph);
  for (const CompiledPass& pass : graph.passes) text += fmt::format("{} {}\n", pass.name, pass.stream);
  return text;
}

TEST_F(Culling, ShuffledKeysGiveTheSamePlan) {
  const Json graph = Json::parse(
      graphOf({"s: Source", "m: Many", "-a: Filter i=s.o", "b: Mix a=a.o b=m.a", "c: Mix a=b.o b=c.o@previous",
               "h: Half i=c.o", "q: Quarter i=h.o", "j: Join full=c.o half=h.o quarter=q.o", "unread: Filter i=j.o",
               "d: Filter i=m.b", "e: Filter i=m.b", "f: Maybe i=d.o extra=e.o", "z: Mix a=f.o b=j.o"},
              {{"x", "z.o"}, {"y", "c.o@previous"}, {"w", "m.a"}}));
  std::mt19937 random(5);
  const auto shuffled = [&](const Json& object, const auto& self) -> Json {
    if (!object.is_object()) return object;
    Names keys;
    for (const auto& [key, value] : object.items()) keys.push_back(key);
    std::shuffle(keys.begin(), keys.end(), random);
    Json result = Json::object();
    for (const std::string& key : keys) result[key] = self(object.at(key), self);
    return result;
  };
  const Result first = run(graph.dump(), fakes);
  ASSERT_EQ(first.text(), "");
  for (int i = 0; i < 200; ++i) {
    const std::string text = shuffled(graph, shuffled).dump(1);
    const Result r = run(text, fakes);
    ASSERT_EQ(r.text(), "");
    ASSERT_EQ(planText(r.graph), planText(first.graph)) << text;
  }
}

}  // namespace
}  // namespace weir::graph::test
