// What a host brings, takes and wants to keep: CompileOptions' provided, external and keep.
#include "fakes.h"

#include <gtest/gtest.h>
#include <weir/core/error.h>

namespace weir::graph::test {
namespace {

const std::string kSurface = "gbuffer.surface", kColor = "tonemap.color";

class Provided : public ::testing::Test {
 protected:
  Result compileWith(const CompileOptions& options, const Overrides& overrides = {}) {
    CompileOptions sized = options;
    sized.width = 64;
    sized.height = 32;
    Result r;
    r.description = parse(readFixture("restir_di.json"), "graph.json", r.diagnostics);
    apply(r.description, overrides, r.diagnostics);
    r.graph = compile(r.description, fakes_.catalog(), sized, r.diagnostics);
    return r;
  }
  std::string refusal(const CompileOptions& options) {
    try {
      compileWith(options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  static CompileOptions all() {
    CompileOptions o;
    o.provided = {kSurface, "gbuffer.surface@previous", "gbuffer.emission", "gbuffer.motion"};
    return o;
  }
  Fakes fakes_ = exampleFakes();
};

TEST_F(Provided, APassWhosePortsAllComeFromTheHostDoesNotRun) {
  const Result r = compileWith(all());
  ASSERT_EQ(r.text(), "");
  EXPECT_EQ(r.order(), (std::vector<std::string>{"initial", "temporal", "spatial", "shade", "tonemap"}));
  EXPECT_EQ(r.source("temporal", "previousSurface"), "gbuffer.surface@previous");
  const Resource& past = r.resource("gbuffer.surface@previous");
  EXPECT_TRUE(past.external);
  EXPECT_EQ(past.producer, kNone);
  EXPECT_FALSE(past.history);
  ASSERT_EQ(r.graph.skipped.size(), 1u);
  EXPECT_NE(r.graph.skipped[0].reason.find("the host provides"), std::string::npos) << r.graph.skipped[0].reason;
  for (const CompiledPass& pass : r.graph.passes)
    for (const Dependency& d : pass.dependencies) EXPECT_FALSE(r.graph.resources[d.resource].producer == kNone);
  EXPECT_NE(explain(r.graph).find("the host's"), std::string::npos);
  EXPECT_NE(dot(r.graph).find("\"host:\" -> \"initial\" [label=\"gbuffer.surface\""), std::string::npos)
      << dot(r.graph);
}

TEST_F(Provided, APassOfWhichSomeIsProvidedStillRunsForTheRest) {
  CompileOptions o;
  o.provided = {"gbuffer.motion"};
  const Result r = compileWith(o);
  ASSERT_EQ(r.text(), "");
  EXPECT_EQ(r.order().front(), "gbuffer");
  uint32_t named = 0;
  for (const Resource& resource : r.graph.resources) named += resource.name == "gbuffer.motion" ? 1 : 0;
  EXPECT_EQ(named, 2u) << "the pass writes one of its own, temporal reads the host's";
  const CompiledPass& temporal = r.pass("temporal");
  for (const Binding& input : temporal.inputs)
    if (input.port == "motion") {
      EXPECT_EQ(r.graph.resources[input.resource].producer, kNone);
    }
}

TEST_F(Provided, ThePastHasToBeProvidedToo) {
  CompileOptions o;
  o.provided = {kSurface};
  const std::string text = refusal(o);
  EXPECT_NE(text.find("provide 'gbuffer.surface@previous' too"), std::string::npos) << text;
  EXPECT_NE(text.find("temporal"), std::string::npos) << text;
}

TEST_F(Provided, ADisabledPassCanStandForTheHost) {
  CompileOptions o;
  o.provided = {"spatial.reservoirs@previous"};
  const Result r = compileWith(o, {{}, {}, {"spatial"}});
  ASSERT_EQ(r.text(), "");
  EXPECT_EQ(r.source("shade", "reservoirs"), "temporal.reservoirs") << "what it passes through";
  EXPECT_EQ(r.source("temporal", "history"), "spatial.reservoirs@previous") << "and not what it passes through";
}

TEST_F(Provided, ADisabledPassThatPassesNothingThroughCanToo) {
  const Result r = compileWith(all(), {{}, {}, {"gbuffer"}});
  ASSERT_EQ(r.text(), "");
  EXPECT_EQ(r.source("shade", "emission"), "gbuffer.emission");
}

TEST_F(Provided, InTheMiddleOfAChainOfDisabledPasses) {
  CompileOptions o;
  o.provided = {"temporal.reservoirs"};
  const Result r = compileWith(o, {{}, {}, {"spatial", "temporal"}});
  ASSERT_EQ(r.text(), "");
  EXPECT_EQ(r.source("shade", "reservoirs"), "temporal.reservoirs") << "and not what that one passes through";
  EXPECT_EQ(r.graph.resources[r.pass("shade").inputs[2].resource].producer, kNone);
}

TEST_F(Provided, WrongNamesAreRefusedWithTheNearest) {
  CompileOptions o;
  o.provided = {"gbuffer.surfice"};
  EXPECT_NE(refusal(o).find("nearest: 'gbuffer.surface'"), std::string::npos) << refusal(o);
  o.provided = {"gbuffer.motion", "gbuffer.motion"};
  EXPECT_NE(refusal(o).find("twice"), std::string::npos) << refusal(o);
  o.provided = {"gbuffer.motion"};
  o.external = {"gbuffer.motion"};
  EXPECT_NE(refusal(o).find("both"), std::string::npos) << refusal(o);
  o = {};
  o.external = {"tonemap.colour"};
  EXPECT_NE(refusal(o).find("nearest: 'tonemap.color'"), std::string::npos) << refusal(o);
  o.external = {"gbuffer.surface"};
  EXPECT_NE(refusal(o).find("@previous"), std::string::npos) << refusal(o);
  o.external = {"gbuffer.motion"};
  o.provided = {kSurface, "gbuffer.surface@previous", "gbuffer.emission"};
  EXPECT_EQ(refusal(o), "");
  o.external = {"temporal.reservoirs"};
  o.provided = {"spatial.reservoirs", "spatial.reservoirs@previous"};
  EXPECT_NE(refusal(o).find("does not run"), std::string::npos) << refusal(o);
  o = {};
  o.keep = {"shade.colr"};
  EXPECT_NE(refusal(o).find("nearest: 'shade.color'"), std::string::npos) << refusal(o);
}

TEST_F(Provided, FindingsOfTheGraphComeFirst) {
  Fakes fewer;  // every type is unknown
  CompileOptions o = all();
  o.width = o.height = 8;
  std::vector<Diagnostic> diagnostics;
  const Description description = parse(readFixture("restir_di.json"), "graph.json", diagnostics);
  EXPECT_NO_THROW(compile(description, fewer.catalog(), o, diagnostics));
  EXPECT_FALSE(diagnostics.empty());
}

TEST_F(Provided, WhatIsExternalIsWrittenAndSynchronizedByNobodyElse) {
  CompileOptions o;
  o.external = {kColor};
  const Result r = compileWith(o);
  ASSERT_EQ(r.text(), "");
  const Resource& color = r.resource(kColor);
  EXPECT_TRUE(color.external);
  EXPECT_EQ(color.block, kNone);
  EXPECT_EQ(r.graph.passes[color.producer].name, "tonemap");
  for (const Dependency& d : r.pass("tonemap").dependencies) EXPECT_NE(r.graph.resources[d.resource].name, kColor);
}

TEST_F(Provided, WhatIsKeptLivesToTheEndAndAPassThatDoesNotRunIsNoError) {
  CompileOptions o;
  o.keep = {"gbuffer.motion", "spatial.reservoirs"};
  const Result r = compileWith(o, {{}, {}, {"spatial"}});
  ASSERT_EQ(r.text(), "");
  EXPECT_EQ(r.resource("gbuffer.motion").lastUse, r.graph.passes.size() - 1);
  EXPECT_TRUE(r.resource("gbuffer.motion").kept);
}

TEST_F(Provided, ACircleOfCountsThatTheHostCutsIsSaid) {
  fakes_.add("t.Like").input("in", buffer("Reservoir")).anyCount();
  fakes_.add("t.Like").output("out", buffer("Reservoir")).countOf("in");
  CompileOptions o;
  o.width = o.height = 8;
  o.provided = {"a.out"};
  std::vector<Diagnostic> diagnostics;
  const Description description = parse(R"({"version": 1, "passes": {"a": {"type": "t.Like", "inputs": {"in": "b.out"}},
               "b": {"type": "t.Like", "inputs": {"in": "a.out"}}}, "outputs": {"o": "b.out"}})",
                                        "graph.json", diagnostics);
  compile(description, fakes_.catalog(), o, diagnostics);
  ASSERT_EQ(diagnostics.size(), 1u);
  EXPECT_NE(diagnostics[0].message.find("depends on itself"), std::string::npos) << diagnostics[0].message;
}

}  // namespace
}  // namespace weir::graph::test
