// Every kind of finding, and the plan of the documented example.
#include "fakes.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace weir::graph::test {
namespace {

class Compile : public ::testing::Test {
 protected:
  Fakes fakes = exampleFakes();
  std::string example = readFixture("restir_di.json");

  Result ok(const std::string& json, const Overrides& overrides = {}) {
    Result result = run(json, fakes, overrides);
    EXPECT_EQ(result.text(), "");
    return result;
  }
  Diagnostic only(const std::string& json, const Overrides& overrides = {}) {
    const Result result = run(json, fakes, overrides);
    EXPECT_EQ(result.diagnostics.size(), 1u) << result.text();
    return result.diagnostics.empty() ? Diagnostic{} : result.diagnostics.front();
  }
  /// The example with one text replaced gives one diagnostic.
  Diagnostic change(const std::string& from, const std::string& to) { return only(replaced(example, from, to)); }
};

void expectSays(const Diagnostic& diagnostic, const std::string& path, int line, const std::string& words,
                const std::string& nearest = "") {
  EXPECT_EQ(diagnostic.path, path);
  EXPECT_EQ(diagnostic.line, line) << diagnostic.text();
  EXPECT_NE(diagnostic.message.find(words), std::string::npos) << diagnostic.text();
  EXPECT_EQ(diagnostic.nearest, nearest) << diagnostic.text();
}

TEST_F(Compile, TheExample) {
  fakes.check();
  const Result r = ok(example);
  EXPECT_EQ(r.graph.name, "restir-di");
  EXPECT_EQ(r.order(), (std::vector<std::string>{"gbuffer", "initial", "temporal", "spatial", "shade", "tonemap"}));
  EXPECT_EQ(r.source("temporal", "previousSurface"), "gbuffer.surface@previous");
  EXPECT_EQ(r.source("temporal", "history"), "spatial.reservoirs@previous");
  EXPECT_EQ(r.graph.outputs.size(), 2u);
  EXPECT_EQ(r.graph.resources[r.graph.findOutput("radiance")->resource].name, "shade.color");
  EXPECT_EQ(r.graph.findOutput("nothing"), nullptr);
  EXPECT_TRUE(r.graph.skipped.empty());

  EXPECT_EQ(std::get<int32_t>(r.pass("spatial").params.at("iterations")), 2);
  EXPECT_EQ(std::get<float>(r.pass("spatial").params.at("radius")), 30.0f) << "an integer will do for a float";
  EXPECT_EQ(std::get<std::string>(r.pass("temporal").params.at("mis")), "balance") << "defaults are filled in";

  const Resource& surface = r.resource("gbuffer.surface");
  EXPECT_TRUE(surface.history);
  EXPECT_FALSE(surface.graphOutput);
  EXPECT_EQ(surface.elements, 64u * 32u);
  EXPECT_EQ(surface.bytes, 64u * 32u * 32u);
  EXPECT_EQ(surface.producer, 0u);
  EXPECT_EQ(surface.firstUse, 0u);
  EXPECT_EQ(surface.lastUse, 4u);
  const Resource& color = r.resource("tonemap.color");
  EXPECT_TRUE(color.graphOutput);
  EXPECT_FALSE(color.history);
  EXPECT_EQ(color.bytes, 64u * 32u * 4u);
  EXPECT_FALSE(r.resource("initial.reservoirs").history);
}

TEST_F(Compile, SixFaultsGiveSixDiagnostics) {
  const Result r = run(readFixture("six_faults.json"), fakes);
  ASSERT_EQ(r.diagnostics.size(), 6u) << r.text();
  expectSays(*r.at("nmae"), "nmae", 3, "unknown key", "name");
  expectSays(*r.at("passes.initial.inputs.surface"), "passes.initial.inputs.surface", 7, "no pass 'gbufer'", "gbuffer");
  expectSays(*r.at("passes.temporal.inputs.motion"), "passes.temporal.inputs.motion", 11, "no output 'moton'",
             "motion");
  expectSays(*r.at("passes.temporal.inputs.history"), "passes.temporal.inputs.history", 14,
             "cycle: spatial → temporal → spatial");
  expectSays(*r.at("passes.spatial.params.neighbors"), "passes.spatial.params.neighbors", 18, "unknown parameter",
             "neighbours");
  expectSays(*r.at("passes.spatial.params.radius"), "passes.spatial.params.radius", 19, "a number from 1 to 200");
}

TEST_F(Compile, CompileFileThrowsThemInTheFilesOrder) {
  const std::string path = std::string(WEIR_SOURCE_DIR) + "/tests/graph/files/six_faults.json";
  try {
    compileFile(path, {}, fakes.catalog(), 64, 32);
    FAIL() << "it must throw";
  } catch (const GraphError& error) {
    ASSERT_EQ(error.diagnostics().size(), 6u);
    const int lines[] = {3, 7, 11, 14, 18, 19};
    for (size_t i = 0; i < 6; ++i) EXPECT_EQ(error.diagnostics()[i].line, lines[i]);
    EXPECT_NE(std::string(error.what()).find(path + ":18: passes.spatial.params.neighbors: unknown parameter"),
              std::string::npos)
        << error.what();
    EXPECT_NE(std::string(error.what()).find("(nearest: 'neighbours')"), std::string::npos);
  }
}

TEST_F(Compile, AnUnknownTypeMakesNoNoiseForItsReaders) {
  expectSays(change("restir_di.Initial", "restir_di.Intial"), "passes.initial.type", 6, "unknown type",
             "restir_di.Initial");
}

TEST_F(Compile, TheCatalogSaysWhyATypeIsMissing) {
  PassCatalog catalog = fakes.catalog();
  catalog.problem = [](const std::string&) { return std::string("its plugin was built yesterday"); };
  std::vector<Diagnostic> diagnostics;
  const Description d = parse(replaced(example, "restir_di.Initial", "x.Y"), "g.json", diagnostics);
  compile(d, catalog, 8, 8, diagnostics);
  ASSERT_EQ(diagnostics.size(), 1u);
  EXPECT_NE(diagnostics[0].message.find("built yesterday"), std::string::npos);
}

TEST_F(Compile, UnknownPassesAndPorts) {
  expectSays(change("\"initial.reservoirs\"", "\"inital.reservoirs\""), "passes.temporal.inputs.reservoirs", 12,
             "no pass", "initial");
  expectSays(change("\"initial.reservoirs\"", "\"initial.reservoir\""), "passes.temporal.inputs.reservoirs", 12,
             "no output", "reservoirs");
  expectSays(change("\"color\": \"tonemap.color\"", "\"color\": \"tonmap.color\""), "outputs.color", 22, "no pass",
             "tonemap");
  expectSays(change("\"color\": \"tonemap.color\"", "\"color\": \"tonemap.colour\""), "outputs.color", 22, "no output",
             "color");
}

TEST_F(Compile, AMisspeltInputIsNotAlsoUnconnected) {
  expectSays(change("\"motion\": ", "\"moton\": "), "passes.temporal.inputs.moton", 10, "unknown input", "motion");
}

TEST_F(Compile, AnInputOfNoNameIsTwoFaultsOnlyWhenItIsTwo) {
  const Result r = run(replaced(example, "\"motion\": ", "\"xyzzy\": "), fakes);
  ASSERT_EQ(r.diagnostics.size(), 2u) << r.text();
  expectSays(*r.at("passes.temporal.inputs.xyzzy"), "passes.temporal.inputs.xyzzy", 10, "unknown input");
  expectSays(*r.at("passes.temporal.inputs.motion"), "passes.temporal.inputs.motion", 9, "not connected");
}

TEST_F(Compile, RequiredInputs) {
  expectSays(change(", \"motion\": \"gbuffer.motion\"", ""), "passes.temporal.inputs.motion", 9,
             "not connected; expected a reference to image RG32F");
  fakes.add("output.Maybe").input("color", storageImage(Format::RGBA32F)).optional();
  fakes.add("output.Maybe").output("color", storageImage(Format::RGBA8));
  const Result r =
      ok(replaced(example, "\"output.Tonemap\", \"inputs\": { \"color\": \"shade.color\" }", "\"output.Maybe\""));
  EXPECT_EQ(r.source("tonemap", "color"), "");
}

TEST_F(Compile, LayoutMismatchNamesBoth) {
  const Diagnostic image = change("\"emission\": \"gbuffer.emission\"", "\"emission\": \"gbuffer.motion\"");
  expectSays(image, "passes.shade.inputs.emission", 18, "expected image RGBA32F, but 'gbuffer.motion' is image RG32F");
  const Diagnostic layout = change("\"reservoirs\": \"temporal.reservoirs\"", "\"reservoirs\": \"gbuffer.surface\"");
  EXPECT_NE(layout.message.find("Reservoir v1"), std::string::npos) << layout.text();
  EXPECT_NE(layout.message.find("PackedSurface v1"), std::string::npos) << layout.text();
  change("\"motion\": \"gbuffer.motion\"", "\"motion\": \"gbuffer.surface\"");
}

TEST_F(Compile, ALayoutOfTheSameNameAndOtherVersionDoesNotFit) {
  fakes.add("other.Initial").input("surface", buffer("PackedSurface"));
  fakes.add("other.Initial").output("reservoirs", buffer("Reservoir", 2));
  const Diagnostic d = only(replaced(replaced(example, "restir_di.Initial", "other.Initial"),
                                     "\"params\": { \"candidates\": 32, \"visibility\": true }", "\"params\": {}"));
  expectSays(d, "passes.temporal.inputs.reservoirs", 12, "Reservoir v2");
}

TEST_F(Compile, ParameterTypesAndRanges) {
  const auto bad = [&](const std::string& param, const std::string& value, const std::string& words,
                       const std::string& near = "") {
    expectSays(change("\"iterations\": 2", "\"" + param + "\": " + value), "passes.spatial.params." + param, 16, words,
               near);
  };
  bad("iterations", "0", "an integer from 1 to 8");
  bad("iterations", "9", "an integer from 1 to 8");
  bad("iterations", "2.5", "an integer");
  bad("iterations", "1e10", "an integer");
  bad("iterations", "\"2\"", "'2'");
  bad("iterations", "true", "an integer");
  bad("iterations", "null", "null");
  bad("iteration", "2", "unknown parameter", "iterations");
  EXPECT_EQ(
      std::get<int32_t>(
          ok(replaced(example, "\"iterations\": 2", "\"iterations\": 3.0")).pass("spatial").params.at("iterations")),
      3)
      << "a whole number is an integer";
  expectSays(change("\"radius\": 30", "\"radius\": 1e300"), "passes.spatial.params.radius", 16,
             "a number from 1 to 200");
  expectSays(change("\"visibility\": true", "\"visibility\": 1"), "passes.initial.params.visibility", 8,
             "true or false");
}

TEST_F(Compile, Choices) {
  const std::string tail = "\"history\": \"spatial.reservoirs@previous\" }";
  expectSays(only(replaced(example, tail, tail + ",\n\"params\": {\"mis\": \"balanse\"}")),
             "passes.temporal.params.mis", 14, "one of: biased, z, balance, pairwise", "balance");
  const Result r = ok(replaced(example, tail, tail + ", \"params\": {\"mis\": \"pairwise\"}"));
  EXPECT_EQ(std::get<std::string>(r.pass("temporal").params.at("mis")), "pairwise");
}

TEST_F(Compile, Overrides) {
  Overrides o;
  o.set = {"spatial.radius=12.5", "spatial.iterations=3", "temporal.mis=z", "initial.visibility=false",
           "tonemap.label=12"};
  const Result r = ok(example, o);
  EXPECT_EQ(std::get<float>(r.pass("spatial").params.at("radius")), 12.5f);
  EXPECT_EQ(std::get<int32_t>(r.pass("spatial").params.at("iterations")), 3);
  EXPECT_EQ(std::get<std::string>(r.pass("temporal").params.at("mis")), "z");
  EXPECT_EQ(std::get<bool>(r.pass("initial").params.at("visibility")), false);
  EXPECT_EQ(std::get<std::string>(r.pass("tonemap").params.at("label")), "12") << "a text may look like a number";
  o.set = {"spatial.iterations=3", "spatial.iterations=4"};
  EXPECT_EQ(std::get<int32_t>(ok(example, o).pass("spatial").params.at("iterations")), 4) << "the last one counts";
}

TEST_F(Compile, OverridesThatAreWrong) {
  const auto bad = [&](const std::string& set, const std::string& path, const std::string& words,
                       const std::string& near) {
    const Diagnostic d = only(example, {{set}, {}, {}});
    expectSays(d, path, 0, words, near);
    EXPECT_EQ(d.file, "--set");
  };
  bad("spatial.radius=big", "passes.spatial.params.radius", "'big'", "");
  bad("spatial.radius=nan", "passes.spatial.params.radius", "'nan'", "");
  bad("spatial.radius=", "passes.spatial.params.radius", "''", "");
  bad("spatial.radus=3", "passes.spatial.params.radus", "unknown parameter", "radius");
  bad("spatal.radius=3", "spatal", "no pass", "spatial");
  for (const char* malformed : {"spatial.radius", "radius=3", "", "=", ".=", "spatial.=3", ".radius=3"})
    bad(malformed, malformed, "expected pass.param=value", "");
  EXPECT_EQ(only(example, {{}, {"spatal"}, {}}).file, "--enable");
  EXPECT_EQ(only(example, {{}, {}, {"spatal"}}).nearest, "spatial");
  EXPECT_NE(only(example, {{}, {"spatial"}, {"spatial"}}).message.find("both"), std::string::npos);
}

TEST_F(Compile, OneWrongEdgeIsOneCycleHoweverManyItCloses) {
  fakes.add("restir_di.Initial").input("late", storageImage(Format::RGBA32F)).optional();
  expectSays(
      change("\"surface\": \"gbuffer.surface\" }", "\"surface\": \"gbuffer.surface\", \"late\": \"shade.color\" }"),
      "passes.initial.inputs.late", 7, "shade → initial → temporal → spatial → shade");
}

TEST_F(Compile, SeparateCyclesAreReportedEach) {
  Fakes f;
  f.add("t.Two").input("a", storageImage(Format::R32F)).optional();
  f.add("t.Two").input("b", storageImage(Format::R32F)).optional();
  f.add("t.Two").output("o", storageImage(Format::R32F));
  const Result r =
      run("{\"version\": 1, \"passes\": {\n"
          "\"p\": {\"type\": \"t.Two\", \"inputs\": {\"a\": \"q.o\"}},\n"
          "\"q\": {\"type\": \"t.Two\", \"inputs\": {\"a\": \"p.o\"}},\n"
          "\"s\": {\"type\": \"t.Two\", \"inputs\": {\"a\": \"s.o\"}},\n"
          "\"x\": {\"type\": \"t.Two\", \"inputs\": {\"a\": \"y.o\", \"b\": \"z.o\"}},\n"
          "\"y\": {\"type\": \"t.Two\", \"inputs\": {\"a\": \"x.o\"}},\n"
          "\"z\": {\"type\": \"t.Two\", \"inputs\": {\"a\": \"x.o\"}}\n"
          "}, \"outputs\": {\"o\": \"x.o\"}}",
          f);
  ASSERT_EQ(r.diagnostics.size(), 4u) << r.text();
  expectSays(r.diagnostics[0], "passes.p.inputs.a", 2, "q → p → q");
  expectSays(r.diagnostics[1], "passes.s.inputs.a", 4, "s → s");
  expectSays(r.diagnostics[2], "passes.x.inputs.a", 5, "y → x → y");
  expectSays(r.diagnostics[3], "passes.x.inputs.b", 5, "z → x → z");
}

TEST_F(Compile, PassesThatNothingNeedsAreSkippedWithAReason) {
  const std::string more = replaced(example, "\"outputs\": {", "\"outputs\": { \"surface\": \"gbuffer.surface\",");
  EXPECT_EQ(ok(more).graph.skipped.size(), 0u);
  const Result r = ok(replaced(example, "\"color\": \"tonemap.color\", \"radiance\": \"shade.color\"",
                               "\"surface\": \"gbuffer.surface\""));
  EXPECT_EQ(r.order(), std::vector<std::string>{"gbuffer"});
  ASSERT_EQ(r.graph.skipped.size(), 5u);
  EXPECT_EQ(r.graph.skipped[0].pass, "initial");
  EXPECT_NE(r.graph.skipped[0].reason.find("temporal"), std::string::npos) << r.graph.skipped[0].reason;
  EXPECT_EQ(r.graph.skipped.back().reason, "nothing reads it");
  EXPECT_FALSE(r.resource("gbuffer.surface").history) << "its only reader of the last frame is skipped";
}

TEST_F(Compile, WhatOnlyFeedsHistoryStillRuns) {
  // The output reads temporal; spatial is read only as last frame's.
  const Result r = ok(replaced(example, "\"color\": \"tonemap.color\", \"radiance\": \"shade.color\"",
                               "\"r\": \"temporal.reservoirs\""));
  EXPECT_EQ(r.order(), (std::vector<std::string>{"gbuffer", "initial", "temporal", "spatial"}));
  EXPECT_TRUE(r.resource("spatial.reservoirs").history);
}

TEST_F(Compile, OutputsMayReadLastFrame) {
  const Result r = ok(replaced(example, "\"radiance\": \"shade.color\"", "\"radiance\": \"shade.color@previous\""));
  EXPECT_TRUE(r.graph.findOutput("radiance")->previous);
  EXPECT_TRUE(r.resource("shade.color").history);
}

TEST_F(Compile, FrameSizesAreChecked) {
  for (const auto& [width, height] : {std::pair{0u, 8u}, {8u, 0u}, {70000u, 8u}, {0xffffffffu, 0xffffffffu}}) {
    const Result r = run(example, fakes, {}, width, height);
    ASSERT_EQ(r.diagnostics.size(), 1u) << r.text();
    EXPECT_EQ(r.diagnostics[0].file, "--size");
  }
}

TEST_F(Compile, KeysHaveNoOrder) {
  const Result r = ok(example);
  Description turned = r.description;
  std::reverse(turned.passes.begin(), turned.passes.end());
  for (PassEntry& pass : turned.passes) std::reverse(pass.inputs.begin(), pass.inputs.end());
  std::vector<Diagnostic> diagnostics;
  const CompiledGraph graph = compile(turned, fakes.catalog(), 64, 32, diagnostics);
  EXPECT_TRUE(diagnostics.empty());
  EXPECT_EQ(explain(graph), explain(r.graph));
  EXPECT_EQ(dot(graph), dot(r.graph));
}

}  // namespace
}  // namespace weir::graph::test
