// Other types for a pass: which fit in the bundled graphs, and what goes with the swap.
#include "view/document/swap.h"

#include <weir/core/error.h>

#include "graphs.h"

namespace weir::view::test {
namespace {

using Names = std::vector<std::string>;

class Swap : public Graphs {
 protected:
  Names possible(const Document& document, const std::string& pass) {
    Names names;
    for (const TypeChoice& choice : fittingTypes(document, context, pass))
      if (choice.possible) names.push_back(choice.type);
    return names;
  }
  Document allLights() const { return Document::load(sourcePath("graphs/all_lights.json")); }
};

TEST_F(Swap, TypesThatFitInTheBundledGraphs) {
  const Document document = restir();
  EXPECT_EQ(possible(document, "gbuffer"), (Names{"gbuffer.Raster", "gbuffer.RayTraced"}));
  EXPECT_EQ(possible(document, "spatial"), (Names{"restir_di.Spatial"}));  // its light is read
  EXPECT_EQ(possible(document, "shade"), (Names{"restir_di.Shade"}));      // and shade's own reservoirs
  // Initial's reservoirs could be anybody's who has what Spatial reads.
  const Names initial = possible(document, "initial");
  EXPECT_NE(std::find(initial.begin(), initial.end(), "restir_di.Initial"), initial.end());
  EXPECT_EQ(std::find(initial.begin(), initial.end(), "gbuffer.Raster"), initial.end());
  // The emission alone is a picture too.
  EXPECT_EQ(possible(allLights(), "direct"),
            (Names{"output.Tonemap", "reference.AllLights", "reference.PathTracer", "template.Scale"}));
}

TEST_F(Swap, EverySwapThatIsOfferedCompilesAndOthersSayWhy) {
  for (const std::string& file : bundledGraphs()) {
    const Document document = Document::load(file);
    for (const graph::PassEntry& pass : document.description().passes)
      for (const TypeChoice& choice : fittingTypes(document, context, pass.name)) {
        if (choice.current) continue;
        Document edited = document;
        if (choice.possible) {
          swapType(edited, context, pass.name, choice.type);
          EXPECT_TRUE(findings(edited).empty()) << file << " " << pass.name << " as " << choice.type;
          edited.undo();
        } else {
          EXPECT_FALSE(choice.reason.empty());
          EXPECT_THROW(swapType(edited, context, pass.name, choice.type), InputError);
        }
        EXPECT_EQ(edited.text(), document.text());
      }
  }
}

TEST_F(Swap, KeepsWhatTheNewTypeHasToo) {
  Document document = allLights();
  document.setParam("gbuffer", "jitter", true);
  const std::string before = document.text();
  swapType(document, context, "gbuffer", "gbuffer.Raster");
  EXPECT_EQ(document.text(), replaced(before, "gbuffer.RayTraced", "gbuffer.Raster"));
}

TEST_F(Swap, DropsWhatItHasNotAndBringsItBack) {
  Document document = allLights();
  document.setParam("direct", "samples", int32_t{4});
  document.setParam("direct", "environment", std::string("uniform"));
  const std::string before = document.text();
  const SwapPlan plan = planSwap(document, context, "direct", "reference.PathTracer");
  ASSERT_TRUE(plan.possible) << plan.reason;
  const PassDescription* tracer = registry.find("reference.PathTracer");
  for (const std::string& dropped : plan.dropped)
    EXPECT_TRUE(dropped == "params.samples" || dropped == "params.environment") << dropped;
  swapType(document, context, "direct", "reference.PathTracer");
  for (const graph::ParamEntry& param : document.description().find("direct")->params)
    EXPECT_NE(tracer->findParam(param.name), nullptr) << param.name;
  EXPECT_FALSE(plan.dropped.empty());
  swapType(document, context, "direct", "reference.AllLights");
  EXPECT_EQ(document.text(), before);

  // Also when the pass was edited in between: then what was left out joins what is there.
  swapType(document, context, "direct", "reference.PathTracer");
  document.setParam("direct", tracer->params.front().name, tracer->params.front().defaultValue);
  swapType(document, context, "direct", "reference.AllLights");
  EXPECT_TRUE(findings(document).empty());
  for (const char* name : {"samples", "environment"}) {
    const graph::PassEntry& pass = *document.description().find("direct");
    EXPECT_EQ(std::count_if(pass.params.begin(), pass.params.end(), [&](const auto& p) { return p.name == name; }), 1)
        << name;
  }
}

/// Types made for the cases that the bundled ones do not have.
class SwapFakes : public ::testing::Test {
 protected:
  SwapFakes() {
    PassDescription& source = add("t.Source");
    source.output("color", storageImage(Format::RGBA32F));
    source.output("depth", storageImage(Format::R32F));
    PassDescription& plain = add("t.Plain");
    plain.input("color", storageImage(Format::RGBA32F));
    plain.output("color", storageImage(Format::RGBA32F)).passesThrough("color");
    plain.param("strength", 1.0f).range(0, 10);
    plain.param("steps", 2).range(1, 8);
    PassDescription& deep = add("t.Deep");
    deep.input("color", storageImage(Format::RGBA32F));
    deep.input("depth", storageImage(Format::R32F));
    deep.output("color", storageImage(Format::RGBA32F)).passesThrough("color");
    deep.param("strength", 1.0f).range(0, 2);
    deep.param("steps", 2.5f).range(1, 8);
    PassDescription& other = add("t.OtherName");
    other.input("picture", storageImage(Format::RGBA32F));
    other.output("color", storageImage(Format::RGBA32F));
    PassDescription& lonely = add("t.Lonely");
    lonely.input("color", storageImage(Format::RGBA32F));
    lonely.input("weights", storageImage(Format::R32U));
    lonely.output("color", storageImage(Format::RGBA32F));
    PassDescription& wrong = add("t.WrongFormat");
    wrong.input("color", storageImage(Format::RGBA32F));
    wrong.output("color", storageImage(Format::RGBA8));
    catalog_.find = [this](const std::string& type) {
      const auto found = types_.find(type);
      return found == types_.end() ? nullptr : &found->second;
    };
    catalog_.types = [this] {
      Names names;
      for (const auto& [name, unused] : types_) names.push_back(name);
      return names;
    };
  }
  PassDescription& add(const std::string& type) {
    types_[type].type = type;
    return types_[type];
  }
  static Document graph(const std::string& strength = "1") {
    return Document::fromText(R"({ "version": 1, "passes": {
      "in": { "type": "t.Source" },
      "mid": { "type": "t.Plain", "inputs": { "color": "in.color" }, "params": { "strength": )" +
                                  strength + R"(, "steps": 3 } },
      "end": { "type": "t.Plain", "inputs": { "color": "mid.color" } } },
      "outputs": { "color": "end.color" } })",
                              "graph.json");
  }
  TypeChoice choice(const Document& document, const std::string& type) {
    for (const TypeChoice& c : fittingTypes(document, context_, "mid"))
      if (c.type == type) return c;
    return {};
  }

  std::map<std::string, PassDescription> types_;
  graph::PassCatalog catalog_;
  SwapContext context_{catalog_, 64, 64};
};

TEST_F(SwapFakes, ConnectsWhatIsMissing) {
  Document document = graph();
  swapType(document, context_, "mid", "t.Deep");  // depth: the only output of that name
  const graph::PassEntry& deep = *document.description().find("mid");
  ASSERT_EQ(deep.inputs.size(), 2u);
  EXPECT_EQ(deep.inputs[1].text, "in.depth");
  swapType(document, context_, "mid", "t.OtherName");  // picture: the only fitting thing that was dropped
  ASSERT_EQ(document.description().find("mid")->inputs.size(), 1u);
  EXPECT_EQ(document.description().find("mid")->inputs[0].text, "in.color");
  swapType(document, context_, "mid", "t.Plain");
  std::vector<graph::Diagnostic> findings;
  graph::compile(document.description(), catalog_, 64, 64, findings);
  EXPECT_TRUE(findings.empty());
}

TEST_F(SwapFakes, KeepsParametersOfTheSameKindInRange) {
  Document inRange = graph("1.5"), outOfRange = graph("9");
  swapType(inRange, context_, "mid", "t.Deep");
  ASSERT_EQ(inRange.description().find("mid")->params.size(), 1u);  // steps is of another kind
  EXPECT_EQ(inRange.description().find("mid")->params[0].name, "strength");
  swapType(outOfRange, context_, "mid", "t.Deep");
  EXPECT_TRUE(outOfRange.description().find("mid")->params.empty());
  const std::string before = graph("9").text();
  swapType(outOfRange, context_, "mid", "t.Plain");
  EXPECT_EQ(outOfRange.text(), before);
}

TEST_F(SwapFakes, SaysWhatCannotBe) {
  const Document document = graph();
  EXPECT_FALSE(choice(document, "t.Lonely").possible);
  EXPECT_NE(choice(document, "t.Lonely").reason.find("'weights'"), std::string::npos);
  EXPECT_EQ(choice(document, "t.WrongFormat").type, "");  // what it makes cannot be read: it is not offered
  EXPECT_NE(planSwap(document, context_, "mid", "t.WrongFormat").reason.find("end reads its 'color'"),
            std::string::npos);
  EXPECT_NE(planSwap(document, context_, "mid", "t.Nothing").reason.find("no type 't.Nothing'"), std::string::npos);
  EXPECT_THROW(planSwap(document, context_, "middle", "t.Plain"), InputError);
  EXPECT_TRUE(choice(document, "t.Plain").current);
  EXPECT_NE(choice(document, "t.OtherName").changes.find("params.strength"), std::string::npos);
  EXPECT_NE(choice(document, "t.OtherName").changes.find("inputs.picture ← in.color"), std::string::npos);
}

TEST_F(SwapFakes, AGraphWithAnUnknownTypeCanBeMendedByASwap) {
  Document document = graph();
  document.setType("mid", "t.Gone");
  EXPECT_TRUE(choice(document, "t.Plain").possible);
  swapType(document, context_, "mid", "t.Plain");
  EXPECT_EQ(document.text(), graph().text());
}

}  // namespace
}  // namespace weir::view::test
