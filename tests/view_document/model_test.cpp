// What panels show of a graph.
#include "view/document/model.h"

#include <ctime>

#include "graphs.h"

namespace weir::view::test {
namespace {

using Names = std::vector<std::string>;

class Model : public Graphs {
 protected:
  GraphModel modelOf(const Document& document, const std::string& choicesOf = "") {
    ModelInput input{document, context, nullptr, {}, choicesOf};
    const std::vector<graph::Diagnostic> found = findings(document);
    if (found.empty()) running_ = compiled(document);
    input.running = &running_;
    input.problems = problemsOf(found);
    return buildModel(input);
  }
  static Names namesOf(const GraphModel& model) {
    Names names;
    for (const PassModel& pass : model.passes) names.push_back(pass.name);
    return names;
  }
  static const PortModel& input(const GraphModel& model, const std::string& pass, const std::string& port) {
    for (const PortModel& p : model.find(pass)->inputs)
      if (p.name == port) return p;
    throw std::out_of_range(port);
  }
  static const ParamModel& param(const GraphModel& model, const std::string& pass, const std::string& name) {
    for (const ParamModel& p : model.find(pass)->params)
      if (p.description.name == name) return p;
    throw std::out_of_range(name);
  }
  graph::CompiledGraph running_;
};

TEST_F(Model, ShowsTheRestirGraph) {
  const GraphModel model = modelOf(restir());
  EXPECT_EQ(namesOf(model), (Names{"gbuffer", "initial", "temporal", "spatial", "shade", "tonemap"}));
  EXPECT_EQ(model.edges.size(), 13u);
  EXPECT_EQ(std::count_if(model.edges.begin(), model.edges.end(), [](const EdgeModel& e) { return e.previous; }), 2);
  EXPECT_TRUE(input(model, "temporal", "history").previous);
  EXPECT_EQ(input(model, "temporal", "history").port, "shade.reservoirs");
  EXPECT_EQ(model.find("spatial")->outputs[0].port, "spatial.reservoirs");
  EXPECT_EQ(model.find("shade")->outputs.back().readers, (Names{"tonemap.color", "output radiance"}));
  const ParamModel& radius = param(model, "spatial", "radius");
  EXPECT_EQ(std::get<float>(radius.value), 6.0f);
  EXPECT_TRUE(radius.changed && radius.written);
  EXPECT_NE(radius.tooltip.find("from 1 to 1024, px"), std::string::npos) << radius.tooltip;
  EXPECT_NE(radius.tooltip.find("default: 30"), std::string::npos) << radius.tooltip;
  EXPECT_FALSE(param(model, "spatial", "mis").changed);
  EXPECT_FALSE(param(model, "initial", "candidates").changed);  // written, and the default
  EXPECT_TRUE(param(model, "initial", "candidates").written);
  EXPECT_EQ(model.find("spatial")->changed, 2u);
  EXPECT_NE(param(model, "shade", "visibility").tooltip.find("rebuilds pipelines"), std::string::npos);
  EXPECT_FALSE(model.find("gbuffer")->mustRun.empty());
  EXPECT_TRUE(model.find("temporal")->mustRun.empty());
  EXPECT_FALSE(model.find("tonemap")->mustRun.empty());
  EXPECT_EQ(model.find("initial")->outputs[0].type, "Reservoir, 1 a pixel");
  EXPECT_TRUE(model.choicesOf.empty());
  EXPECT_EQ(modelOf(restir(), "gbuffer").choices.size(), 2u);
}

TEST_F(Model, WhetherAPassCanBeDisabledIsWhatTheCompilerSays) {
  for (const std::string& file : bundledGraphs()) {
    const Document document = Document::load(file);
    const GraphModel model = modelOf(document);
    for (const PassModel& pass : model.passes) {
      Document edited = document;
      edited.setEnabled(pass.name, false);
      EXPECT_EQ(findings(edited).empty(), pass.mustRun.empty()) << file << " " << pass.name << ": " << pass.mustRun;
    }
  }
}

TEST_F(Model, PassesThatDoNotRunStandWhereTheyWould) {
  Document document = restir();
  document.setEnabled("temporal", false);
  document.addPass("unread", "template.Scale");
  document.setInput("unread", "color", "shade.color");
  document.addPass("early", "gbuffer.Raster");
  const GraphModel model = modelOf(document);
  const Names names = namesOf(model);
  ASSERT_EQ(names.size(), 8u);
  const auto at = [&](const std::string& name) { return std::find(names.begin(), names.end(), name) - names.begin(); };
  EXPECT_EQ(at("temporal"), 2);
  EXPECT_EQ(at("unread"), at("shade") + 1);
  EXPECT_FALSE(model.find("temporal")->runs);
  EXPECT_FALSE(model.find("temporal")->enabled);
  EXPECT_NE(model.find("temporal")->reason.find("disabled"), std::string::npos);
  EXPECT_EQ(model.find("unread")->reason, "nothing reads it");
  EXPECT_EQ(model.edges.size(), 14u);  // those of passes that don't run too
}

TEST_F(Model, ProblemsStandWhereTheyCanBeMended) {
  Document document = restir();
  (void)modelOf(document);
  document.setParam("spatial", "radius", 5000.0f);
  document.setParam("spatial", "radios", 3.0f);
  document.setInput("shade", "light", "gbuffer.motion");
  document.setType("tonemap", "output.Tonemop");
  const GraphModel model = modelOf(document);
  EXPECT_EQ(model.problems.size(), 4u);
  const ParamModel& radius = param(model, "spatial", "radius");
  ASSERT_EQ(radius.problems.size(), 1u);
  EXPECT_NE(radius.problems[0].find("from 1 to 1024"), std::string::npos);
  EXPECT_EQ(std::get<float>(radius.value), 30.0f);
  EXPECT_EQ(model.find("spatial")->problems.size(), 1u);  // there is no such parameter to say it at
  EXPECT_EQ(input(model, "shade", "light").problems.size(), 1u);
  EXPECT_FALSE(model.find("tonemap")->known);
  EXPECT_EQ(model.find("tonemap")->problems.size(), 1u);
  EXPECT_EQ(namesOf(model), (Names{"gbuffer", "initial", "temporal", "spatial", "shade", "tonemap"}));
}

TEST_F(Model, AGraphThatNeverCompiledIsShownToo) {
  Document document = restir();
  document.setType("gbuffer", "gbuffer.None");
  ModelInput input{document, context, nullptr, problemsOf(findings(document)), ""};
  const GraphModel model = buildModel(input);
  EXPECT_EQ(namesOf(model), (Names{"gbuffer", "initial", "temporal", "spatial", "shade", "tonemap"}));
  EXPECT_FALSE(model.find("shade")->runs);
  EXPECT_FALSE(model.find("shade")->reason.empty());
}

/// As many passes as a graph may have, in a circle or a chain, running or not: still built in a moment.
TEST_F(Model, LargeGraphsTakeNoQuadraticTime) {
  for (const bool circle : {false, true}) {
    std::string passes, last = circle ? "p" + std::to_string(graph::kMostPasses - 1) : "first";
    for (size_t i = 0; i < graph::kMostPasses; ++i) {
      const std::string name = i == 0 && !circle ? "first" : "p" + std::to_string(i);
      passes += (i > 0 ? ",\n" : "") +
                ("\"" + name + "\": { \"type\": \"template.Scale\", \"enabled\": false, \"inputs\": ") +
                "{ \"color\": \"" + last + ".color\" } }";
      last = name;
    }
    const Document document = Document::fromText(
        "{ \"version\": 1, \"passes\": {" + passes + "}, \"outputs\": { \"c\": \"" + last + ".color\" } }", "g");
    ModelInput input{document, context, nullptr, {{"", "", "something"}}, ""};
    const std::clock_t begin = std::clock();  // of this process, whatever else the machine does
    const GraphModel model = buildModel(input);
    const double took = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    EXPECT_EQ(model.passes.size(), graph::kMostPasses);
    EXPECT_EQ(model.edges.size(), graph::kMostPasses);
    EXPECT_LT(took, 1.0);
  }
}

}  // namespace
}  // namespace weir::view::test
