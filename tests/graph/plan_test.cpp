// Sizes, element counts and order on graphs small enough to work out by hand; and what people read of them.
#include "fakes.h"

#include <gtest/gtest.h>

namespace weir::graph::test {
namespace {

std::string graphOf(const std::string& passes, const std::string& outputs) {
  return "{\"version\": 1, \"name\": \"small\", \"passes\": {\n" + passes + "\n}, \"outputs\": {" + outputs + "}}";
}

class Plan : public ::testing::Test {
 protected:
  Plan() {
    fakes.add("t.Source").output("o", storageImage(Format::R32F));
    fakes.add("t.Filter").input("i", storageImage(Format::R32F));
    fakes.add("t.Filter").output("o", storageImage(Format::R32F));
    PassDescription& mix = fakes.add("t.Mix");
    mix.input("a", storageImage(Format::R32F));
    mix.input("b", storageImage(Format::R32F));
    mix.output("o", storageImage(Format::R32F));
    PassDescription& many = fakes.add("t.Many");
    many.input("in", buffer("Reservoir")).anyCount();
    many.output("timesN", buffer("Reservoir")).times("n");
    many.output("like", buffer("Reservoir")).countOf("in");
    many.output("half", storageImage(Format::RGBA16F)).scale(1, 2);
    many.output("table", fixedOf(buffer("Reservoir"), 100));
    many.param("n", 3).range(0, 1 << 30);
    fakes.add("t.One").output("o", buffer("Reservoir"));
    fakes.add("t.ReadOne").input("i", buffer("Reservoir"));
    fakes.add("t.ReadOne").output("o", storageImage(Format::R32F));
    fakes.add("t.ReadTable").input("i", fixedOf(buffer("Reservoir"), 100));
    fakes.add("t.ReadTable").output("o", storageImage(Format::R32F));
    fakes.add("t.ReadHalf").input("i", storageImage(Format::RGBA16F)).scale(1, 2);
    fakes.add("t.ReadHalf").output("o", storageImage(Format::R32F));
    fakes.check();
  }
  static PortType fixedOf(PortType type, uint32_t count) {
    type.fixedCount = count;
    return type;
  }
  Fakes fakes;
};

const std::string kMany =
    "\"one\": {\"type\": \"t.One\"}, \"many\": {\"type\": \"t.Many\", \"inputs\": {\"in\": \"one.o\"}}";

TEST_F(Plan, SizesAndCounts) {
  const Result r = run(graphOf(kMany + ",\n\"again\": {\"type\": \"t.Many\", \"inputs\": {\"in\": \"many.timesN\"}, "
                                       "\"params\": {\"n\": 7}}",
                               "\"x\": \"again.like\""),
                       fakes, {}, 65, 33);
  EXPECT_EQ(r.text(), "");
  EXPECT_EQ(r.resource("many.timesN").perPixel, 3u);
  EXPECT_EQ(r.resource("many.timesN").elements, 65u * 33u * 3u);
  EXPECT_EQ(r.resource("many.timesN").bytes, 65u * 33u * 3u * 32u);
  EXPECT_EQ(r.resource("many.like").perPixel, 1u);
  EXPECT_EQ(r.resource("again.timesN").perPixel, 7u);
  EXPECT_EQ(r.resource("again.like").perPixel, 3u);
  EXPECT_EQ(r.resource("many.half").width, 33u) << "rounded up";
  EXPECT_EQ(r.resource("many.half").height, 17u);
  EXPECT_EQ(r.resource("many.half").bytes, 33u * 17u * 8u);
  EXPECT_EQ(r.resource("many.half").elements, 0u);
  EXPECT_EQ(r.resource("many.table").elements, 100u);
  EXPECT_EQ(r.resource("many.table").width, 0u);
  EXPECT_EQ(r.resource("many.table").bytes, 3200u);
}

TEST_F(Plan, CountsThatDoNotFit) {
  const auto says = [&](const std::string& type, const std::string& port, const std::string& words) {
    const Result r =
        run(graphOf(kMany + ",\n\"r\": {\"type\": \"" + type + "\", \"inputs\": {\"i\": \"many." + port + "\"}}",
                    "\"x\": \"r.o\""),
            fakes);
    if (words.empty()) {
      EXPECT_EQ(r.text(), "");
      return;
    }
    ASSERT_EQ(r.diagnostics.size(), 1u) << r.text();
    EXPECT_EQ(r.diagnostics[0].line, 3);
    EXPECT_EQ(r.diagnostics[0].path, "passes.r.inputs.i");
    EXPECT_NE(r.text().find(words), std::string::npos) << r.text();
  };
  says("t.ReadOne", "like", "");
  says("t.ReadOne", "timesN", "with 3 elements a pixel");
  says("t.ReadOne", "table", "with 100 elements");
  says("t.ReadTable", "table", "");
  says("t.ReadTable", "like", "expected Reservoir");
  says("t.ReadHalf", "half", "");
  says("t.Filter", "half", "image R32F");
}

TEST_F(Plan, ScalesMustAgree) {
  fakes.add("t.ReadFull").input("i", storageImage(Format::RGBA16F));
  fakes.add("t.ReadFull").output("o", storageImage(Format::R32F));
  const Result r =
      run(graphOf(kMany + ",\"r\": {\"type\": \"t.ReadFull\", \"inputs\": {\"i\": \"many.half\"}}", "\"x\": \"r.o\""),
          fakes);
  ASSERT_EQ(r.diagnostics.size(), 1u) << r.text();
  EXPECT_NE(r.text().find("at the frame's size"), std::string::npos) << r.text();
  EXPECT_NE(r.text().find("at 1/2 of the frame's size"), std::string::npos) << r.text();
}

TEST_F(Plan, CountsOutOfAllBounds) {
  const auto with = [&](const std::string& n) {
    return run(
        graphOf("\"one\": {\"type\": \"t.One\"}, \"many\": {\"type\": \"t.Many\", \"inputs\": {\"in\": \"one.o\"},\n"
                "\"params\": {\"n\": " +
                    n + "}}",
                "\"x\": \"many.timesN\""),
        fakes);
  };
  EXPECT_NE(with("0").text().find("graph.json:3: passes.many.params.n"), std::string::npos) << with("0").text();
  EXPECT_EQ(with("0").diagnostics.size(), 1u);
  EXPECT_EQ(with("2000000").diagnostics.size(), 0u);
  EXPECT_EQ(with("1000000000").diagnostics.size(), 1u);
}

TEST_F(Plan, ACountThatDependsOnItselfIsAnError) {
  const Result r = run(
      graphOf("\"m\": {\"type\": \"t.Many\", \"inputs\": {\"in\": \"m.like@previous\"}}", "\"x\": \"m.like\""), fakes);
  ASSERT_EQ(r.diagnostics.size(), 1u) << r.text();
  EXPECT_NE(r.text().find("depends on itself"), std::string::npos);
}

TEST_F(Plan, ACountThatGoesRoundWithinAFrameIsACycleAndSaidOnce) {
  const Result r = run(graphOf("\"m\": {\"type\": \"t.Many\", \"inputs\": {\"in\": \"k.like\"}},\n"
                               "\"k\": {\"type\": \"t.Many\", \"inputs\": {\"in\": \"m.like\"}}",
                               "\"x\": \"m.like\""),
                       fakes);
  ASSERT_EQ(r.diagnostics.size(), 1u) << r.text();
  EXPECT_NE(r.text().find("cycle"), std::string::npos) << r.text();
}

TEST_F(Plan, TiesAreBrokenByName) {
  const Result r = run(graphOf("\"z\": {\"type\": \"t.Source\"}, \"a\": {\"type\": \"t.Source\"},\n"
                               "\"b\": {\"type\": \"t.Mix\", \"inputs\": {\"a\": \"z.o\", \"b\": \"a.o\"}}",
                               "\"x\": \"b.o\""),
                       fakes);
  EXPECT_EQ(r.order(), (std::vector<std::string>{"a", "z", "b"}));
}

TEST_F(Plan, StreamsDependOnTheNameOnly) {
  const Result r =
      run(graphOf("\"a\": {\"type\": \"t.Source\"}, \"b\": {\"type\": \"t.Source\"}", "\"x\": \"a.o\", \"y\": \"b.o\""),
          fakes);
  const uint64_t hash = fnv1a("a");
  EXPECT_EQ(r.pass("a").stream, static_cast<uint32_t>(hash ^ (hash >> 32)));
  EXPECT_NE(r.pass("a").stream, r.pass("b").stream);
}

TEST_F(Plan, ExplainAndDotSayWhatTheyShould) {
  const Fakes example = exampleFakes();
  const Result r = run(readFixture("restir_di.json"), example, {{}, {}, {"spatial"}}, 1920, 1080);
  const std::string text = explain(r.graph);
  for (const char* words :
       {"Graph 'restir-di' at 1920x1080 (graph.json)", "  1. gbuffer (gbuffer.RayTraced)",
        "surface <- gbuffer.surface\n", "previousSurface <- gbuffer.surface@previous", "mis = balance",
        "wait until gbuffer.surface can be read, which gbuffer wrote\n",
        "spatial: it is disabled; temporal.reservoirs stands for its 'reservoirs'", "radiance <- shade.color",
        "two copies of its own: history", "barrier compute writes -> compute reads\n",
        "wait for 6 more: earlier barriers see to it\n", "16.6 MB  ###..  at 99.5 MB\n", "Most alive at once",
        "scene.geometry", "temporal.previousSurface next frame"})
    EXPECT_NE(text.find(words), std::string::npos) << words << "\nis missing in\n" << text;
  const std::string picture = dot(r.graph);
  for (const char* words :
       {"digraph \"restir-di\"", "\"temporal\" -> \"temporal\" [label=\"reservoirs@previous\", style=dashed",
        "\"shade\" -> \"output:radiance\"", "\"spatial\" [color=gray"})
    EXPECT_NE(picture.find(words), std::string::npos) << words << "\nis missing in\n" << picture;
}

}  // namespace
}  // namespace weir::graph::test
