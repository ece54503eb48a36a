// Dependencies and barriers on graphs small enough to work out by hand.
#include "fakes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace weir::graph::test {
namespace {

constexpr Stages C = kComputeStage, R = kRayStage, G = kRasterStage;

class Barriers : public ::testing::Test {
 protected:
  Barriers() {
    for (const char* type : {"t.Source", "t.Rays"}) fakes.add(type).output("o", storageImage(Format::R32F));
    fakes.add("t.Rays").needs(Need::SceneAcceleration);
    fakes.add("t.RaysTwo").output("o", storageImage(Format::R32F));
    fakes.add("t.RaysTwo").output("unread", storageImage(Format::R32F));
    fakes.add("t.RaysTwo").needs(Need::SceneAcceleration);
    fakes.add("t.Filter").input("i", storageImage(Format::R32F));
    fakes.add("t.Filter").output("o", storageImage(Format::R32F));
    fakes.add("t.Mix").input("a", storageImage(Format::R32F));
    fakes.add("t.Mix").input("b", storageImage(Format::R32F));
    fakes.add("t.Mix").output("o", storageImage(Format::R32F));
    fakes.add("t.Two").output("o", storageImage(Format::R32F));
    fakes.add("t.Two").output("unread", storageImage(Format::R32F));
    for (const char* type : {"t.Fill", "t.Copy", "t.Show"}) {
      PassDescription& d = fakes.add(type);
      if (std::string(type) != "t.Fill") d.input("i", buffer("B"));
      if (std::string(type) != "t.Show")
        d.output("o", buffer("B"));
      else
        d.output("o", storageImage(Format::R32F));
    }
    fakes.check();
  }

  Result compiled(const std::string& passes, const std::string& output) {
    Result r = run(
        "{\"version\": 1, \"name\": \"small\", \"passes\": {" + passes + "}, \"outputs\": {\"x\": \"" + output + "\"}}",
        fakes);
    EXPECT_EQ(r.text(), "");
    return r;
  }
  /// Without sharing, so that each resource is alone with its memory.
  static void apart(Result& r) {
    planMemory(r.graph, logicalNeeds(r.graph), false);
    planBarriers(r.graph);
  }
  static CompiledPass& pass(Result& r, const std::string& name) {
    for (CompiledPass& p : r.graph.passes)
      if (p.name == name) return p;
    throw std::out_of_range(name);
  }

  /// "read s.o of s", "s.o after f read s.o -1", … one for each dependency, with how many frames back; in brackets what
  /// earlier barriers see to.
  static std::string waitsOf(const Result& r, const std::string& name) {
    std::string text;
    for (const Dependency& d : r.pass(name).dependencies) {
      const std::string& by = r.graph.passes[d.pass].name;
      std::string one;
      if (d.hazard == Hazard::ReadAfterWrite)
        one = fmt::format("read {} of {}", r.graph.resources[d.resource].name, by);
      else
        one = fmt::format("{} after {} {} {}", r.graph.resources[d.resource].name, by,
                          d.hazard == Hazard::WriteAfterRead ? "read" : "wrote", r.graph.resources[d.memoryOf].name);
      if (d.framesBack > 0) one += fmt::format(" -{}", d.framesBack);
      if (d.covered) one = "(" + one + ")";
      text += (text.empty() ? "" : ", ") + one;
    }
    return text;
  }
  static void expectWaits(const Result& r, const std::string& name, const std::vector<Wait>& waits) {
    EXPECT_EQ(r.pass(name).waits, waits) << name << "\n" << explain(r.graph);
  }

  static constexpr Wait kReads{C, C, true, true, false}, kOrder{C, C, false, false, false},
      kRewrites{C, C, true, false, true}, kBoth{C, C, true, true, true};
  Fakes fakes;
};

const std::string kDiamond = R"("s": {"type": "t.Source"}, "f": {"type": "t.Filter", "inputs": {"i": "s.o"}},
  "g": {"type": "t.Filter", "inputs": {"i": "s.o"}}, "m": {"type": "t.Mix", "inputs": {"a": "f.o", "b": "g.o"}})";

TEST_F(Barriers, OnlyTheFirstReaderWaits) {
  Result r = compiled(kDiamond, "m.o");
  apart(r);
  // In brackets what an earlier barrier sees to: the one before m lies between the last frame's reads of s.o and s.
  EXPECT_EQ(waitsOf(r, "s"), "(s.o after f read s.o -1), (s.o after g read s.o -1)");
  EXPECT_EQ(waitsOf(r, "f"), "read s.o of s, f.o after m read f.o -1");
  EXPECT_EQ(waitsOf(r, "g"), "(read s.o of s), (g.o after m read g.o -1)");
  EXPECT_EQ(waitsOf(r, "m"), "read f.o of f, read g.o of g, m.o after m wrote m.o -1");
  expectWaits(r, "s", {});
  expectWaits(r, "f", {kReads});
  expectWaits(r, "g", {});
  expectWaits(r, "m", {kBoth});
}

TEST_F(Barriers, TheSameInputTwiceIsOneBarrierAndAnUnreadOutputWaitsForItsOwnWrite) {
  Result r = compiled(R"("s": {"type": "t.Two"}, "m": {"type": "t.Mix", "inputs": {"a": "s.o", "b": "s.o"}})", "m.o");
  apart(r);
  EXPECT_EQ(waitsOf(r, "s"), "s.o after m read s.o -1, s.unread after s wrote s.unread -1");
  EXPECT_EQ(waitsOf(r, "m"), "read s.o of s, read s.o of s, (m.o after m wrote m.o -1)");
  expectWaits(r, "s", {kRewrites});
  expectWaits(r, "m", {kReads});
}

TEST_F(Barriers, HistoryCostsNoneOfItsOwn) {
  // m reads its own last frame; n reads m of both frames.
  Result r = compiled(R"("s": {"type": "t.Source"},
    "m": {"type": "t.Mix", "inputs": {"a": "s.o", "b": "m.o@previous"}},
    "n": {"type": "t.Mix", "inputs": {"a": "m.o", "b": "m.o@previous"}})",
                      "n.o");
  apart(r);
  EXPECT_TRUE(r.resource("m.o").history);
  EXPECT_EQ(waitsOf(r, "s"), "(s.o after m read s.o -1)");
  EXPECT_EQ(waitsOf(r, "m"),
            "read s.o of s, (read m.o of m -1), (m.o after n read m.o -2), (m.o after m read m.o -1), "
            "m.o after n read m.o -1");
  EXPECT_EQ(waitsOf(r, "n"), "read m.o of m, (read m.o of m -1), n.o after n wrote n.o -1");
  expectWaits(r, "s", {});
  expectWaits(r, "m", {kReads});
  expectWaits(r, "n", {kBoth});
}

TEST_F(Barriers, RaysAreAStageOfTheirOwn) {
  Result r = compiled(R"("s": {"type": "t.Rays"}, "f": {"type": "t.Filter", "inputs": {"i": "s.o"}})", "f.o");
  apart(r);
  EXPECT_EQ(r.pass("s").stages, R);
  EXPECT_EQ(r.pass("f").stages, C);
  expectWaits(r, "s", {{C, R, false, false, false}});
  expectWaits(r, "f", {{C, C, true, false, true}, {R, C, true, true, false}});
  // A pass that works in two stages waits in both, and is waited for in both.
  pass(r, "f").stages = C | G;
  planBarriers(r.graph);
  expectWaits(r, "s", {{C | G, R, false, false, false}});
  expectWaits(r, "f", {{C | G, C | G, true, false, true}, {R, C | G, true, true, false}});
}

TEST_F(Barriers, EachStageThatReadsWaits) {
  // s, by rays, is read by compute, and then by raster, which waits for compute too: one barrier from both.
  Result r = compiled(R"("s": {"type": "t.Rays"}, "f": {"type": "t.Filter", "inputs": {"i": "s.o"}},
    "m": {"type": "t.Mix", "inputs": {"a": "s.o", "b": "f.o"}})",
                      "m.o@previous");
  pass(r, "m").stages = G;
  apart(r);
  EXPECT_EQ(waitsOf(r, "f"), "read s.o of s, f.o after m read f.o -1");
  EXPECT_EQ(waitsOf(r, "m"), "read s.o of s, read f.o of f, m.o after m wrote m.o -2");
  expectWaits(r, "s", {{C | G, R, false, false, false}});
  expectWaits(r, "f", {{R, C, true, true, false}, {G, C, false, false, false}});
  expectWaits(r, "m", {{C | R, G, true, true, false}, {G, G, true, false, true}});
}

TEST_F(Barriers, WhoeverTakesOverMemoryWaitsForWhoHadIt) {
  Result r = compiled(R"("a": {"type": "t.Fill"}, "b": {"type": "t.Copy", "inputs": {"i": "a.o"}},
    "c": {"type": "t.Copy", "inputs": {"i": "b.o"}}, "d": {"type": "t.Show", "inputs": {"i": "c.o"}})",
                      "d.o");
  // Worked out by hand: a.o and c.o lie at the start, b.o behind them, and d.o, smaller, takes some of b.o's place.
  constexpr uint64_t kBuffer = 64 * 32 * 32;
  ASSERT_EQ(r.graph.blocks.size(), 1u);
  EXPECT_EQ(r.graph.sharedBytes(), 2 * kBuffer);
  EXPECT_EQ(r.resource("a.o").offset, 0u);
  EXPECT_EQ(r.resource("b.o").offset, kBuffer);
  EXPECT_EQ(r.resource("c.o").offset, 0u);
  EXPECT_EQ(r.resource("d.o").offset, kBuffer);
  EXPECT_EQ(waitsOf(r, "a"), "a.o after d read c.o -1");
  EXPECT_EQ(waitsOf(r, "b"), "read a.o of a, b.o after d wrote d.o -1, (b.o after c read b.o -1)");
  EXPECT_EQ(waitsOf(r, "c"), "read b.o of b, c.o after b read a.o");
  EXPECT_EQ(waitsOf(r, "d"), "read c.o of c, (d.o after c read b.o)");
  expectWaits(r, "a", {kOrder});
  expectWaits(r, "b", {kBoth});
  expectWaits(r, "c", {kReads});
  expectWaits(r, "d", {kReads});
  const auto d = static_cast<uint32_t>(&r.resource("d.o") - r.graph.resources.data());
  EXPECT_EQ(r.pass("d").starts, (std::vector<ImageStart>{{d, C}}));
  EXPECT_TRUE(r.pass("a").starts.empty() && r.pass("b").starts.empty() && r.pass("c").starts.empty());
}

TEST_F(Barriers, WhatWasNeverReadIsMadeAvailableBeforeAnImageStartsThere) {
  Result r = compiled(R"("s": {"type": "t.RaysTwo"}, "f": {"type": "t.Filter", "inputs": {"i": "s.o"}})", "f.o");
  ASSERT_TRUE(shareMemory(r.resource("s.unread"), r.resource("f.o")));
  EXPECT_EQ(waitsOf(r, "s"), "s.o after f read s.o -1, s.unread after f wrote f.o -1");
  EXPECT_EQ(waitsOf(r, "f"), "read s.o of s, f.o after s wrote s.unread");
  // Before s.unread changes its layout, what was written there, as f.o, is made available: by a barrier for all memory.
  expectWaits(r, "s", {{C, R, true, false, true}});
  EXPECT_EQ(r.pass("s").starts, (std::vector<ImageStart>{{1, C}}));
  expectWaits(r, "f", {{R, C, true, true, true}});
  EXPECT_EQ(r.pass("f").starts, (std::vector<ImageStart>{{2, R}}));
  const std::string text = explain(r.graph);
  for (const char* words :
       {"1. s (t.RaysTwo), rays\n", "2. f (t.Filter), compute\n", "wait until s.o can be read, which s wrote\n",
        "wait until f is done writing f.o in the last frame, whose memory s.unread takes over\n",
        "barrier compute writes -> rays writes\n", "barrier compute -> rays: s.unread starts undefined\n",
        "barrier rays writes -> compute reads writes\n", "barrier rays -> compute: f.o starts undefined\n",
        "at 8192 B, shared; output"})
    EXPECT_NE(text.find(words), std::string::npos) << words << "\nis missing in\n" << text;
}

}  // namespace
}  // namespace weir::graph::test
