// The graph panel, driven as a user drives it: mouse and keys go in, requests come out, and what they ask for is done.
#include "desk.h"

#include <weir/pass/registry.h>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <imgui.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <random>
#include <vector>

#include "support/device.h"

namespace weir::view::test {
namespace {

class GraphPanel : public ::testing::Test {
 protected:
  static Document restir() { return Document::load(weir::test::sourcePath("graphs/restir_di.json")); }
  Registry registry{{std::filesystem::path(weir::test::binaryPath("bin"))}};
  graph::PassCatalog catalog = registry.catalog();
};

void expectNoEdits(Desk& desk) {
  for (const GraphRequests& requests : desk.take()) EXPECT_TRUE(requests.edits.empty());
}

float valueOf(const SetParam& edit) {
  return std::holds_alternative<float>(edit.value) ? std::get<float>(edit.value) : -1.0f;
}

TEST_F(GraphPanel, ACheckBoxDisablesAPass) {
  Desk d{restir(), catalog};
  d.robot->click("graph/temporal/enabled");
  const auto off = d.only<SetEnabled>();
  EXPECT_EQ(off.pass, "temporal");
  EXPECT_FALSE(off.enabled);
  EXPECT_FALSE(d.model().find("temporal")->runs);
  // It stands where it stood, so that the same place puts it on again.
  d.robot->click("graph/temporal/enabled");
  EXPECT_TRUE(d.only<SetEnabled>().enabled);
  EXPECT_FALSE(d.document().changed());
  // What everything needs can't be put off.
  d.robot->click("graph/gbuffer/enabled");
  expectNoEdits(d);
  EXPECT_TRUE(d.model().find("gbuffer")->enabled);
}

TEST_F(GraphPanel, AClickOpensAPassAndAnotherClosesIt) {
  Desk d{restir(), catalog};
  EXPECT_FALSE(d.robot->has("graph/spatial/radius"));
  d.robot->click("graph/spatial");
  EXPECT_EQ(d.state.selected, "spatial");
  for (const ParamDescription& param : registry.find("restir_di.Spatial")->params)
    EXPECT_TRUE(d.robot->has("graph/spatial/" + param.name)) << param.name;
  d.robot->click("graph/spatial");
  EXPECT_EQ(d.state.selected, "");
  EXPECT_FALSE(d.robot->has("graph/spatial/radius"));
}

TEST_F(GraphPanel, CtrlClickOnASliderTakesDigits) {
  Desk d{restir(), catalog};
  d.state.selected = "spatial";
  d.robot->frame(2);
  const auto typed = [&](const std::string& param, const std::string& text) {
    d.robot->click("graph/spatial/" + param, {.control = true});
    d.robot->key(Key::A, {.control = true});
    d.robot->type(text);
    d.robot->key(Key::Enter);
    return d.only<SetParam>();
  };
  SetParam edit = typed("radius", "123.456");
  EXPECT_EQ(edit.pass + "." + edit.param, "spatial.radius");
  EXPECT_EQ(valueOf(edit), 123.456f);
  EXPECT_EQ(valueOf(typed("radius", "99999")), 1024.0f);  // kept within the range
  EXPECT_EQ(valueOf(typed("radius", "0.25")), 1.0f);
  edit = typed("neighbours", "12");
  EXPECT_EQ(std::get<int32_t>(edit.value), 12);
  EXPECT_EQ(std::get<int32_t>(typed("neighbours", "99").value), 16);
  d.robot->frame();
  EXPECT_TRUE(d.model().problems.empty());
  // Escape leaves it as it was.
  d.robot->click("graph/spatial/radius", {.control = true});
  d.robot->type("7");
  d.robot->key(Key::Escape);
  expectNoEdits(d);
}

TEST_F(GraphPanel, ADoubleClickTakesDigitsToo) {
  Desk d{restir(), catalog};
  d.state.selected = "spatial";
  d.robot->frame(2);
  d.robot->doubleClick("graph/spatial/radius");
  d.take();
  d.robot->key(Key::A, {.control = true});
  d.robot->type("55.5");
  d.robot->key(Key::Enter);
  EXPECT_EQ(valueOf(d.only<SetParam>()), 55.5f);
}

TEST_F(GraphPanel, ADragIsOneStepAndStaysInRange) {
  Desk d{restir(), catalog};
  d.state.selected = "spatial";
  d.robot->frame(2);
  const std::string before = d.document().text();
  d.robot->drag("graph/spatial/radius", {30.0f, 0.0f}, 6);
  std::vector<SetParam> edits;
  for (const GraphRequests& requests : d.take())
    for (const Edit& edit : requests.edits) edits.push_back(std::get<SetParam>(edit));
  ASSERT_GE(edits.size(), 3u);
  EXPECT_FALSE(edits.front().continues);
  for (size_t i = 1; i < edits.size(); ++i) {
    EXPECT_TRUE(edits[i].continues);
    EXPECT_GE(valueOf(edits[i]), valueOf(edits[i - 1]));
  }
  d.robot->click("graph/undo");
  EXPECT_EQ(d.document().text(), before);
  d.take();
  d.robot->drag("graph/spatial/radius", {900.0f, 0.0f});
  EXPECT_EQ(std::get<float>(d.model().find("spatial")->params[2].value), 1024.0f);
  d.robot->drag("graph/spatial/radius", {-900.0f, 0.0f});
  EXPECT_EQ(std::get<float>(d.model().find("spatial")->params[2].value), 1.0f);
}

/// Where every value would rebuild pipelines, only the last is asked for.
TEST_F(GraphPanel, ParametersThatSpecialiseAreAskedForWhenLetGo) {
  PassDescription pass;
  pass.type = "t.Pass";
  pass.output("color", storageImage(Format::RGBA32F));
  pass.param("count", 10).range(0, 100).specialises();
  pass.param("free", 1.0f);
  pass.param("huge", 7).range(-2147483648.0, 2147483647.0);
  pass.param("percent", 50.0f).range(0, 100).unit("% of %s");
  pass.param("text", "some");
  graph::PassCatalog one;
  one.find = [&](const std::string& type) { return type == pass.type ? &pass : nullptr; };
  one.types = [&] { return std::vector<std::string>{pass.type}; };
  Desk d(Document::fromText(
             R"({ "version": 1, "passes": { "a": { "type": "t.Pass" } }, "outputs": { "c": "a.color" } })", "g.json"),
         one);
  d.state.selected = "a";
  d.robot->frame(2);
  d.robot->drag("graph/a/count", {25.0f, 0.0f}, 8);
  const auto edit = d.only<SetParam>();
  EXPECT_GT(std::get<int32_t>(edit.value), 10);
  EXPECT_FALSE(edit.continues);
  // Without a range: dragged, and typed.
  d.robot->drag("graph/a/free", {40.0f, 0.0f}, 4);
  EXPECT_GT(std::get<float>(d.model().find("a")->params[1].value), 1.0f);
  d.take();
  d.robot->click("graph/a/huge", {.control = true});
  d.robot->key(Key::A, {.control = true});
  d.robot->type("-2000000000");
  d.robot->key(Key::Enter);
  EXPECT_EQ(std::get<int32_t>(d.only<SetParam>().value), -2000000000);
  d.robot->drag("graph/a/percent", {10.0f, 0.0f});
  EXPECT_GT(std::get<float>(d.model().find("a")->params[3].value), 50.0f);
  d.take();
  // A text is asked for once, when it is done.
  d.robot->click("graph/a/text");
  d.robot->key(Key::End);
  d.robot->type(" wörds");
  expectNoEdits(d);
  d.robot->key(Key::Enter);
  EXPECT_EQ(std::get<std::string>(d.only<SetParam>().value), "some wörds");
}

TEST_F(GraphPanel, ChoicesTicksAndReset) {
  Desk d{restir(), catalog};
  d.state.selected = "temporal";
  d.robot->frame(2);
  EXPECT_FALSE(d.robot->has("graph/temporal/mis/reset"));
  d.robot->click("graph/temporal/mis");
  d.robot->click("graph/temporal/mis/z");
  EXPECT_EQ(std::get<std::string>(d.only<SetParam>().value), "z");
  EXPECT_EQ(d.model().find("temporal")->changed, 1u);
  d.robot->click("graph/temporal/mis/reset");
  EXPECT_EQ(d.only<ResetParam>().param, "mis");
  EXPECT_FALSE(d.document().changed());
  EXPECT_FALSE(d.robot->has("graph/temporal/mis/reset"));
  d.robot->click("graph/temporal/visibilityRays");
  EXPECT_TRUE(std::get<bool>(d.only<SetParam>().value));
}

TEST_F(GraphPanel, SwapsAPassForAnotherThatFits) {
  Desk d{restir(), catalog};
  d.state.selected = "gbuffer";
  d.robot->frame(2);
  d.robot->click("graph/gbuffer/type");
  EXPECT_TRUE(d.robot->has("graph/gbuffer/type/gbuffer.RayTraced"));
  d.robot->click("graph/gbuffer/type/gbuffer.Raster");
  const auto swap = d.only<SwapType>();
  EXPECT_EQ(swap.pass + " " + swap.type, "gbuffer gbuffer.Raster");
  EXPECT_EQ(d.model().find("gbuffer")->type, "gbuffer.Raster");
  EXPECT_TRUE(d.model().problems.empty());
}

TEST_F(GraphPanel, AClickOnAPortShowsIt) {
  Desk d{restir(), catalog};
  d.robot->click("graph/gbuffer/port/motion");
  EXPECT_EQ(d.state.shown, "gbuffer.motion");
  d.robot->click("graph/temporal/input/history");  // on the right, as it comes from the last frame
  EXPECT_EQ(d.state.shown, "shade.reservoirs");
  d.robot->click("graph/shade/input/light");
  EXPECT_EQ(d.state.shown, "spatial.light");
  d.robot->click("graph/spatial");
  d.robot->click("graph/spatial/source/surface");
  EXPECT_EQ(d.state.shown, "gbuffer.surface");
}

TEST_F(GraphPanel, SavesUndoesAndNamesAnotherFile) {
  Desk d{restir(), catalog};
  const auto saves = [&] {
    const std::vector<GraphRequests> asked = d.take();
    return std::count_if(asked.begin(), asked.end(), [](const GraphRequests& r) { return r.save; });
  };
  d.robot->click("graph/save");
  EXPECT_EQ(saves(), 0);  // nothing to save
  d.robot->click("graph/temporal/enabled");
  d.robot->click("graph/save");
  EXPECT_EQ(saves(), 1);
  d.robot->click("graph/undo");
  EXPECT_FALSE(d.document().changed());
  d.robot->click("graph/redo");
  EXPECT_TRUE(d.document().changed());
  d.robot->click("graph/save_as");
  d.robot->click("graph/save_path");
  d.robot->key(Key::A, {.control = true});
  d.robot->type("other.json");
  d.take();
  d.robot->click("graph/save_ok");
  std::vector<std::string> paths;
  for (const GraphRequests& requests : d.take())
    if (!requests.saveAs.empty()) paths.push_back(requests.saveAs);
  EXPECT_EQ(paths, (std::vector<std::string>{"other.json"}));
}

TEST_F(GraphPanel, SaysWhatIsWrongWhereItIs) {
  Desk d{restir(), catalog};
  d.document().setParam("spatial", "radius", 5000.0f);
  d.document().setType("tonemap", "output.None");
  d.rebuild();
  d.robot->frame(2);
  EXPECT_EQ(d.model().problems.size(), 2u);
  EXPECT_TRUE(d.robot->has("graph/problem/0"));
  d.robot->click("graph/problem/0");
  EXPECT_EQ(d.state.selected, "spatial");
  // What can't be read is the default, and a reset mends the graph.
  d.robot->click("graph/spatial/radius/reset");
  EXPECT_EQ(d.only<ResetParam>().param, "radius");
  EXPECT_EQ(d.model().problems.size(), 1u);
  // An edit that was refused leaves the panel as it was.
  d.carriesOut = false;
  d.robot->click("graph/temporal/enabled");
  EXPECT_TRUE(d.model().find("temporal")->enabled);
}

/// Somebody who clicks, drags, scrolls and types anywhere.
TEST_F(GraphPanel, LivesThroughAnything) {
  std::mt19937 random(1);
  Desk d{restir(), catalog};
  const std::vector<std::string> texts = {"1", "-", "1e9", "abc", "%s", ".", "/", "ä"};
  for (int i = 0; i < 1500; ++i) {
    const std::vector<std::string> names = d.robot->marks().names();
    ASSERT_FALSE(names.empty());
    const std::string name = names[random() % names.size()];
    const auto offset = [&] { return static_cast<float>(random() % 400) - 200.0f; };
    switch (random() % 8) {
      case 0:
        d.robot->drag(name, {offset(), offset()}, 2);
        break;
      case 1:
        d.robot->doubleClick(name);
        break;
      case 2:
        d.robot->click(name, {.control = true});
        break;
      case 3:
        d.robot->type(texts[random() % texts.size()]);
        break;
      case 4:
        d.robot->key(static_cast<Key>(1 + random() % (static_cast<unsigned>(Key::Count) - 1)));
        break;
      default:
        d.robot->click(name);
    }
  }
  EXPECT_EQ(d.model().passes.size(), 6u);
}

}  // namespace
}  // namespace weir::view::test
