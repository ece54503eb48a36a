// Disabled passes: what stands for them, also in the last frame, and when they can't be disabled.
#include "fakes.h"

#include <gtest/gtest.h>

namespace weir::graph::test {
namespace {

class Disable : public ::testing::Test {
 protected:
  Fakes fakes = exampleFakes();
  std::string example = readFixture("restir_di.json");

  Result disable(const std::vector<std::string>& passes, const std::string& json) {
    return run(json, fakes, {{}, {}, passes});
  }
  Result disable(const std::vector<std::string>& passes) { return disable(passes, example); }
};

TEST_F(Disable, ReadersReadWhatItPassesThroughAlsoInTheLastFrame) {
  const Result r = disable({"spatial"});
  EXPECT_EQ(r.text(), "");
  EXPECT_EQ(r.order(), (std::vector<std::string>{"gbuffer", "initial", "temporal", "shade", "tonemap"}));
  EXPECT_EQ(r.source("shade", "reservoirs"), "temporal.reservoirs");
  EXPECT_EQ(r.source("temporal", "history"), "temporal.reservoirs@previous");
  EXPECT_TRUE(r.resource("temporal.reservoirs").history);
  ASSERT_EQ(r.graph.skipped.size(), 1u);
  EXPECT_EQ(r.graph.skipped[0].pass, "spatial");
  EXPECT_EQ(r.graph.skipped[0].reason, "it is disabled; temporal.reservoirs stands for its 'reservoirs'");
}

TEST_F(Disable, TheFileCanSaySoAndTheCommandLineCanUndoIt) {
  const std::string json =
      replaced(example, "\"type\": \"restir_di.Spatial\",", "\"type\": \"restir_di.Spatial\", \"enabled\": false,");
  EXPECT_EQ(run(json, fakes).source("shade", "reservoirs"), "temporal.reservoirs");
  EXPECT_EQ(run(json, fakes, {{}, {"spatial"}, {}}).source("shade", "reservoirs"), "spatial.reservoirs");
}

TEST_F(Disable, Chains) {
  const Result r = disable({"spatial", "temporal"});
  EXPECT_EQ(r.text(), "");
  EXPECT_EQ(r.source("shade", "reservoirs"), "initial.reservoirs");
  EXPECT_FALSE(r.resource("gbuffer.surface").history);
  EXPECT_FALSE(r.resource("initial.reservoirs").history) << "its reader as last frame's was temporal";
  EXPECT_EQ(r.graph.skipped.size(), 2u);
}

TEST_F(Disable, OutputsResolveToo) {
  const Result r =
      disable({"spatial"}, replaced(example, "\"color\": \"tonemap.color\"",
                                    "\"color\": \"tonemap.color\", \"r\": \"spatial.reservoirs@previous\""));
  EXPECT_EQ(r.text(), "");
  const GraphOutput* output = r.graph.findOutput("r");
  EXPECT_EQ(r.graph.resources[output->resource].name, "temporal.reservoirs");
  EXPECT_TRUE(output->previous);
}

TEST_F(Disable, WithoutAPassThroughItIsAnErrorOnceForAllReaders) {
  const Result r = disable({"gbuffer"});
  ASSERT_EQ(r.diagnostics.size(), 3u) << r.text();  // one for each of its outputs that is read
  for (const Diagnostic& d : r.diagnostics) {
    EXPECT_EQ(d.file, "--disable");
    EXPECT_EQ(d.path, "passes.gbuffer.enabled");
    EXPECT_NE(d.message.find("can't be disabled"), std::string::npos);
  }
  const Result file = run(replaced(example, "\"output.Tonemap\",", "\"output.Tonemap\",\n\"enabled\": false,"), fakes);
  ASSERT_EQ(file.diagnostics.size(), 1u) << file.text();
  EXPECT_EQ(file.diagnostics[0].line, 21);
  EXPECT_NE(file.diagnostics[0].message.find("its output 'color' is read and passes nothing through"),
            std::string::npos);
}

TEST_F(Disable, WhatNobodyReadsNeedsNoPassThrough) {
  const Result r = disable({"tonemap"}, replaced(example, "\"color\": \"tonemap.color\", ", ""));
  EXPECT_EQ(r.text(), "");
  EXPECT_EQ(r.order().size(), 5u);
}

// An extra that is there only while its pass is: who can do without it is left without, who can't is an error.
TEST_F(Disable, ExtrasAreAbsent) {
  fakes.add("x.Source").output("color", storageImage(Format::RGBA32F));
  PassDescription& filter = fakes.add("x.Filter");
  filter.input("color", storageImage(Format::RGBA32F));
  filter.output("color", storageImage(Format::RGBA32F)).passesThrough("color");
  filter.output("extra", storageImage(Format::RGBA32F)).absentWhenDisabled();
  PassDescription& reader = fakes.add("x.Reader");
  reader.input("color", storageImage(Format::RGBA32F));
  reader.input("extra", storageImage(Format::RGBA32F)).optional();
  reader.output("color", storageImage(Format::RGBA32F));
  const auto graph = [](const char* input, const char* source) {
    return std::string(R"({"version": 1, "passes": {"s": {"type": "x.Source"},
"f": {"type": "x.Filter", "inputs": {"color": "s.color"}},
"r": {"type": "x.Reader", "inputs": {"color": "f.color", ")") +
           input + "\": \"" + source + R"("}}},
"outputs": {"o": "r.color"}})";
  };
  const Result enabled = run(graph("extra", "f.extra"), fakes);
  EXPECT_EQ(enabled.text(), "");
  EXPECT_EQ(enabled.source("r", "extra"), "f.extra");
  const Result r = disable({"f"}, graph("extra", "f.extra"));
  EXPECT_EQ(r.text(), "");
  EXPECT_EQ(r.source("r", "color"), "s.color");
  for (const Binding& b : r.graph.passes.back().inputs) EXPECT_EQ(b.resource == kNone, b.port == "extra") << b.port;
  // Last frame's too.
  EXPECT_EQ(disable({"f"}, graph("extra", "f.extra@previous")).text(), "");
  std::string needed = graph("extra", "f.extra");
  needed = replaced(needed, "\"color\": \"f.color\", \"extra\"", "\"color\"");
  const Result failed = disable({"f"}, needed);
  ASSERT_EQ(failed.diagnostics.size(), 1u) << failed.text();
  EXPECT_NE(failed.diagnostics[0].message.find("its output 'extra' is read and passes nothing through"),
            std::string::npos);
}

TEST_F(Disable, ADisabledReaderDoesNotCount) {
  // temporal reads gbuffer's motion, which nothing stands for; with temporal disabled nobody asks.
  fakes.add("x.Denoise").input("color", storageImage(Format::RGBA32F));
  fakes.add("x.Denoise").output("color", storageImage(Format::RGBA32F)).passesThrough("color");
  fakes.add("x.Source").output("color", storageImage(Format::RGBA32F));
  const std::string json =
      "{\"version\": 1, \"passes\": {\"s\": {\"type\": \"x.Source\"}, \"t\": {\"type\": \"x.Source\", \"enabled\": "
      "false},\n"
      "\"d\": {\"type\": \"x.Denoise\", \"enabled\": false, \"inputs\": {\"color\": \"t.color\"}}}, \"outputs\": "
      "{\"o\": \"s.color\"}}";
  EXPECT_EQ(run(json, fakes).text(), "");
}

TEST_F(Disable, AnotherLayoutOrAnOpenInputCantStandForIt) {
  PassDescription& convert = fakes.add("x.Convert");
  convert.input("color", storageImage(Format::RGBA32F)).optional();
  convert.output("color", storageImage(Format::RGBA8)).passesThrough("color");
  convert.output("same", storageImage(Format::RGBA32F)).passesThrough("color");
  const auto graph = [](const std::string& inputs, const std::string& port) {
    return "{\"version\": 1, \"passes\": {\"g\": {\"type\": \"gbuffer.RayTraced\"},\n\"c\": {\"type\": \"x.Convert\", "
           "\"enabled\": false" +
           inputs + "}}, \"outputs\": {\"o\": \"c." + port + "\"}}";
  };
  const Result layout = run(graph(", \"inputs\": {\"color\": \"g.emission\"}", "color"), fakes);
  ASSERT_EQ(layout.diagnostics.size(), 1u) << layout.text();
  EXPECT_EQ(layout.diagnostics[0].line, 2);
  EXPECT_NE(layout.text().find("is image RGBA8, its input 'color', which would stand for it, is image RGBA32F"),
            std::string::npos)
      << layout.text();
  const Result open = run(graph("", "same"), fakes);
  ASSERT_EQ(open.diagnostics.size(), 1u) << open.text();
  EXPECT_NE(open.text().find("is not connected"), std::string::npos) << open.text();
  EXPECT_EQ(run(graph(", \"inputs\": {\"color\": \"g.emission\"}", "same"), fakes).text(), "");
}

TEST_F(Disable, APassedThroughLastFrameStaysOneFrameOld) {
  const std::string json =
      replaced(example, "\"reservoirs\": \"temporal.reservoirs\"", "\"reservoirs\": \"temporal.reservoirs@previous\"");
  // shade reads spatial, which stands aside for temporal's last frame; temporal reads spatial's last frame: two frames
  // back.
  const Result r = disable({"spatial"}, json);
  ASSERT_EQ(r.diagnostics.size(), 1u) << r.text();
  EXPECT_EQ(r.diagnostics[0].path, "passes.temporal.inputs.history");
  EXPECT_EQ(r.diagnostics[0].line, 13);
  EXPECT_NE(r.text().find("two frames old"), std::string::npos) << r.text();
  const Result fine =
      disable({"spatial"}, replaced(json, "spatial.reservoirs@previous", "initial.reservoirs@previous"));
  EXPECT_EQ(fine.text(), "");
  EXPECT_EQ(fine.source("shade", "reservoirs"), "temporal.reservoirs@previous");
}

TEST_F(Disable, CyclesOfDisabledPassesAreReportedOnce) {
  fakes.add("x.Same").input("a", storageImage(Format::R32F));
  fakes.add("x.Same").output("o", storageImage(Format::R32F)).passesThrough("a");
  const Result r =
      run("{\"version\": 1, \"passes\": {\n\"p\": {\"type\": \"x.Same\", \"enabled\": false, \"inputs\": {\"a\": "
          "\"q.o\"}},\n"
          "\"q\": {\"type\": \"x.Same\", \"enabled\": false, \"inputs\": {\"a\": \"p.o\"}}},\n"
          "\"outputs\": {\"o\": \"p.o\", \"u\": \"q.o\"}}",
          fakes);
  ASSERT_EQ(r.diagnostics.size(), 1u) << r.text();
  EXPECT_EQ(r.diagnostics[0].line, 2);
  EXPECT_NE(r.text().find("p → q → p"), std::string::npos);
}

TEST_F(Disable, ACycleMayBeClosedThroughADisabledPass) {
  const Result r = disable({"spatial"}, replaced(example, "spatial.reservoirs@previous", "spatial.reservoirs"));
  ASSERT_EQ(r.diagnostics.size(), 1u) << r.text();
  EXPECT_NE(r.text().find("temporal → temporal"), std::string::npos) << r.text();
}

TEST_F(Disable, ADisabledPassIsStillChecked) {
  const Result r = disable({"spatial"}, replaced(example, "\"radius\": 30", "\"radius\": 3000"));
  ASSERT_EQ(r.diagnostics.size(), 1u) << r.text();
  EXPECT_EQ(r.diagnostics[0].path, "passes.spatial.params.radius");
}

}  // namespace
}  // namespace weir::graph::test
