// The graph that is edited: what is saved is what was loaded and the edits, nothing else.
#include "view/document/document.h"

#include "view/document/edits.h"
#include "view/document/model.h"
#include "view/document/overrides.h"
#include "view/document/render_command.h"

#include <weir/core/error.h>

#include <limits>
#include <random>

#include "graphs.h"

namespace weir::view::test {
namespace {

namespace fs = std::filesystem;

class DocumentTest : public Graphs {
 protected:
  /// The restir graph's text after one replacement.
  static std::string restirWith(const std::string& from, const std::string& to) {
    return replaced(read(sourcePath("graphs/restir_di.json")), from, to);
  }
};

TEST_F(DocumentTest, SavesWhatItLoadedByteForByte) {
  for (const std::string& file : bundledGraphs()) {
    Document document = Document::load(file);
    EXPECT_FALSE(document.changed());
    document.saveAs(folder.path() + "/copy.json");
    EXPECT_EQ(read(folder.path() + "/copy.json"), read(file));
  }
  // Whatever else stands in a file stays as well: spelling of numbers, spaces, line ends.
  const std::string odd =
      "\r\n{\"version\":1 "
      ",\"description\":\"\\u00e4\",\t\"passes\":{\"a\":{\"params\":{\"x\":1.50e1},\"type\":\"t.A\"}},\n\n"
      "\"outputs\":{\"color\":\"a.o\"}}";
  const std::string file = folder.write("odd.json", odd);
  Document document = Document::load(file);
  document.save();
  EXPECT_EQ(read(file), odd);
}

TEST_F(DocumentTest, AnEditChangesWhatItIsAboutAndNothingElse) {
  Document document = restir();
  document.setParam("spatial", "radius", 12.5f);
  EXPECT_EQ(document.text(), restirWith("\"radius\": 6 ", "\"radius\": 12.5 "));
  EXPECT_TRUE(document.changed());
  document.setParam("spatial", "radius", 6.0f);
  EXPECT_FALSE(document.changed());

  document.setParam("shade", "visibility", false);
  EXPECT_EQ(document.text(), restirWith("\"light\": \"spatial.light\" }",
                                        "\"light\": \"spatial.light\" },\n                  "
                                        "\"params\": { \"visibility\": false }"));
  document.resetParam("shade", "visibility");
  EXPECT_FALSE(document.changed());

  document.setEnabled("spatial", false);
  EXPECT_FALSE(document.description().find("spatial")->enabled);
  document.setEnabled("spatial", true);
  EXPECT_FALSE(document.changed());

  document.setParam("temporal", "mis", std::string("z"));
  document.resetParam("spatial", "radius");
  EXPECT_EQ(graph::toText(document.description().find("temporal")->params[0].value), "z");
  EXPECT_EQ(document.description().find("spatial")->params.size(), 2u);
  EXPECT_TRUE(findings(document).empty());
}

TEST_F(DocumentTest, ConnectionsOutputsAndPasses) {
  Document document = restir();
  document.setInput("temporal", "history", "spatial.reservoirs@previous");
  EXPECT_EQ(document.text(), restirWith("shade.reservoirs@previous", "spatial.reservoirs@previous"));
  document.setInput("shade", "light", std::nullopt);
  EXPECT_EQ(document.description().find("shade")->inputs.size(), 3u);
  document.setOutput("first", "initial.reservoirs");
  document.setOutput("radiance", std::nullopt);
  EXPECT_EQ(document.description().outputs.size(), 2u);
  document.addPass("more", "template.Scale");
  document.setInput("more", "color", "shade.color");
  document.setParam("more", "factor", 3.0f);
  EXPECT_TRUE(findings(document).empty());
  document.setType("gbuffer", "gbuffer.Raster");
  EXPECT_EQ(document.description().find("gbuffer")->type, "gbuffer.Raster");
  document.removePass("more");
  EXPECT_EQ(document.description().find("more"), nullptr);
  EXPECT_TRUE(findings(document).empty());
  while (document.canUndo()) document.undo();
  EXPECT_FALSE(document.changed());
}

TEST_F(DocumentTest, RefusesEditsThatLeaveNoGraphAndStaysAsItWas) {
  Document document = restir();
  const std::string before = document.text();
  EXPECT_THROW(document.setInput("temporal", "history", "nonsense"), graph::GraphError);
  EXPECT_THROW(document.addPass("no.name", "t.A"), graph::GraphError);
  EXPECT_THROW(document.addPass("spatial", "t.A"), InputError);
  EXPECT_THROW(document.setParam("spatial", "radius", std::numeric_limits<float>::quiet_NaN()), InputError);
  EXPECT_THROW(document.setParam("tonemap", "view", std::string("\xc3")), InputError);
  EXPECT_THROW(document.setParam("tonemap", "view", std::string(70000, 'x')), graph::GraphError);
  EXPECT_THROW(document.replace("{", "nothing"), graph::GraphError);
  document.setOutput("radiance", std::nullopt);
  EXPECT_THROW(document.setOutput("color", std::nullopt), graph::GraphError);
  document.undo();
  try {
    document.setEnabled("spatail", false);
    ADD_FAILURE() << "there is no such pass";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("nearest: 'spatial'"), std::string::npos) << error.what();
  }
  EXPECT_EQ(document.text(), before);
  EXPECT_FALSE(document.canUndo());
}

TEST_F(DocumentTest, UndoTakesBackStepsAndADragIsOne) {
  Document document = restir();
  const std::string first = document.text();
  document.setParam("spatial", "radius", 7.0f);
  for (int i = 8; i < 20; ++i) document.setParam("spatial", "radius", static_cast<float>(i), true);
  const std::string dragged = document.text();
  document.setParam("spatial", "radius", 5.0f);  // another drag
  document.setParam("spatial", "radius", 4.0f, true);
  document.setEnabled("temporal", false);
  EXPECT_EQ(document.undoes(), "temporal disabled");
  document.undo();
  EXPECT_EQ(document.undoes(), "spatial.radius");
  document.undo();
  EXPECT_EQ(document.text(), dragged);
  document.undo();
  EXPECT_EQ(document.text(), first);
  EXPECT_FALSE(document.canUndo());
  EXPECT_EQ(document.undoes(), "");
  document.redo();
  EXPECT_EQ(document.text(), dragged);
  document.redo();
  document.redo();
  EXPECT_FALSE(document.canRedo());
  EXPECT_FALSE(document.description().find("temporal")->enabled);
  document.undo();
  // A drag that goes on after an undo is no part of what was undone.
  document.setParam("spatial", "radius", 3.0f, true);
  EXPECT_FALSE(document.canRedo());
  document.undo();
  EXPECT_NE(document.text(), first);
}

TEST_F(DocumentTest, UndoIsBounded) {
  Document document = restir();
  for (int i = 0; i < 1000; ++i) document.setParam("spatial", "neighbours", int32_t{1 + i % 16});
  size_t steps = 0;
  while (document.canUndo()) document.undo(), ++steps;
  EXPECT_EQ(steps, 256u);
}

TEST_F(DocumentTest, WhatTheCommandLineChangesIsAnEdit) {
  Document document = restir();
  applyOverrides(document,
                 {.set = {"spatial.radius=12.5", "temporal.mis=z", "tonemap.view=1", "shade.visibility=false"},
                  .enable = {"spatial"},
                  .disable = {"temporal"}},
                 catalog);
  const graph::CompiledGraph direct = graph::compileFile(
      sourcePath("graphs/restir_di.json"),
      {.set = {"spatial.radius=12.5", "tonemap.view=1", "shade.visibility=false"}, .disable = {"temporal"}}, catalog,
      64, 64);
  const graph::CompiledGraph edited = compiled(document);
  ASSERT_EQ(edited.passes.size(), direct.passes.size());
  for (size_t i = 0; i < edited.passes.size(); ++i) EXPECT_EQ(edited.passes[i].params, direct.passes[i].params);
  EXPECT_EQ(graph::toText(document.description().find("temporal")->params[0].value), "z");
  document.undo();
  EXPECT_FALSE(document.changed());
}

TEST_F(DocumentTest, OverridesThatAreWrongChangeNothing) {
  Document document = restir();
  const std::vector<std::pair<graph::Overrides, std::string>> cases = {
      {{.set = {"spatial.radios=3"}}, "nearest: 'radius'"},
      {{.set = {"spatial.radius=0"}}, "from 1 to 1024"},
      {{.set = {"nonsense"}}, "pass.param=value"},
      {{.enable = {}, .disable = {"gbuffer"}}, "can't be disabled"},
      {{.enable = {"spatail"}}, "nearest: 'spatial'"},
  };
  for (const auto& [overrides, words] : cases) {
    try {
      applyOverrides(document, overrides, catalog);
      ADD_FAILURE() << "should have said: " << words;
    } catch (const graph::GraphError& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
    EXPECT_FALSE(document.changed());
  }
}

TEST_F(DocumentTest, BadFilesAreRefusedWithPlaces) {
  const std::string good = read(sourcePath("graphs/template.json"));
  const std::vector<std::pair<std::string, std::string>> cases = {
      {good.substr(0, good.size() / 2), "not valid JSON"},
      {"", "not valid JSON"},
      {"[]", "bad.json:1: a graph must be a JSON object"},
      {replaced(good, "\"params\": { \"factor\": 2 }", "\"params\": 3"), "bad.json:9: passes.scale.params"},
      {replaced(good, "\"params\"", "\"parms\""), "nearest: 'params'"},
      {replaced(good, "\"direct.color\" }, \"params\"", "\"direct\" }, \"params\""),
       "bad.json:9: passes.scale.inputs.color"},
      {replaced(good, "\"factor\": 2", "\"factor\": 2, \"factor\": 3"), "bad.json:9"},
  };
  for (const auto& [text, words] : cases) {
    const std::string file = folder.write("bad.json", text);
    try {
      Document::load(file);
      ADD_FAILURE() << "should have said: " << words;
    } catch (const graph::GraphError& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(Document::load(folder.path()), InputError);
  EXPECT_THROW(Document::load(folder.path() + "/none.json"), InputError);
}

TEST_F(DocumentTest, FollowsItsFile) {
  const std::string file = folder.write("graph.json", read(sourcePath("graphs/template.json")));
  Document document = Document::load(file);
  EXPECT_FALSE(document.fileDiffers());
  document.setParam("scale", "factor", 5.0f);
  EXPECT_FALSE(document.fileDiffers());
  document.save();
  EXPECT_FALSE(document.changed());
  EXPECT_EQ(read(file), document.text());

  folder.write("graph.json", "{");
  EXPECT_TRUE(document.fileDiffers());
  const std::string before = document.text();
  EXPECT_THROW(document.reread(), graph::GraphError);
  EXPECT_EQ(document.text(), before);
  folder.write("graph.json", replaced(before, "\"factor\": 5", "\"factor\": 7"));
  document.reread();
  EXPECT_FALSE(document.changed());
  EXPECT_NE(document.text().find("\"factor\": 7"), std::string::npos);
  document.undo();
  EXPECT_EQ(document.text(), before);
  EXPECT_TRUE(document.changed());
  fs::remove(file);
  EXPECT_TRUE(document.fileDiffers());
}

TEST_F(DocumentTest, SavingElsewhereFailsWithoutTraces) {
  Document document = restir();
  EXPECT_THROW(document.saveAs(folder.path() + "/none/graph.json"), InputError);
  EXPECT_THROW(document.saveAs(folder.path()), InputError);
  EXPECT_EQ(document.file(), sourcePath("graphs/restir_di.json"));
  EXPECT_TRUE(fs::is_empty(folder.path()));
  document.setEnabled("temporal", false);
  document.saveAs(folder.path() + "/other.json");
  EXPECT_EQ(document.file(), folder.path() + "/other.json");
  EXPECT_EQ(document.description().file, document.file());
  EXPECT_FALSE(document.changed());
}

/// Whatever is asked of it, in any order, it stays a graph, and undo finds the way back.
TEST_F(DocumentTest, AnyEditsLeaveAGraphThatUndoTakesBack) {
  const std::vector<std::string> passes = {"gbuffer", "spatial", "shade", "no.such", "", "new", "\"", "\xff"},
                                 words = {"radius", "color",       "a\"b",         "\\", "",
                                          "light",  "shade.color", "x.y@previous", "ä"};
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    const auto any = [&](const std::vector<std::string>& of) { return of[random() % of.size()]; };
    Document document = restir();
    const std::string first = document.text();
    for (int i = 0; i < 60; ++i) {
      const std::string before = document.text();
      try {
        switch (random() % 9) {
          case 0:
            document.setParam(any(passes), any(words), any(words), random() % 2 == 0);
            break;
          case 1:
            document.setParam(any(passes), any(words), static_cast<float>(random()) * 1e-7f, random() % 2 == 0);
            break;
          case 2:
            document.resetParam(any(passes), any(words));
            break;
          case 3:
            document.setEnabled(any(passes), random() % 2 == 0);
            break;
          case 4:
            document.setInput(any(passes), any(words),
                              random() % 2 == 0 ? std::optional<std::string>(any(words)) : std::nullopt);
            break;
          case 5:
            document.setOutput(any(words), random() % 2 == 0 ? std::optional<std::string>(any(words)) : std::nullopt);
            break;
          case 6:
            document.addPass(any(passes), any(words));
            break;
          case 7:
            document.removePass(any(passes));
            break;
          default:
            swapType(document, context, any(passes), any(registry.types()));
        }
      } catch (const InputError&) {
        EXPECT_EQ(document.text(), before);
      }
      std::vector<graph::Diagnostic> found;
      graph::parse(document.text(), "graph.json", found);
      ASSERT_TRUE(found.empty()) << found.front().text() << "\n" << document.text();
      // What panels and the clipboard make of it.
      const GraphModel model = buildModel(
          {document, context, nullptr, problemsOf(findings(document)), document.description().passes[0].name});
      EXPECT_EQ(model.passes.size(), document.description().passes.size());
      (void)renderCommand(document, catalog, {}, std::nullopt);
    }
    while (document.canUndo()) document.undo();
    EXPECT_EQ(document.text(), first);
  }
}

TEST_F(DocumentTest, EditsAsData) {
  Document document = restir();
  const std::string before = document.text();
  carryOut(document, context, SetParam{"spatial", "radius", 8.0f, false});
  carryOut(document, context, ResetParam{"spatial", "neighbours"});
  carryOut(document, context, SetEnabled{"temporal", false});
  carryOut(document, context, SwapType{"gbuffer", "gbuffer.Raster"});
  EXPECT_EQ(document.description().find("gbuffer")->type, "gbuffer.Raster");
  for (int i = 0; i < 4; ++i) carryOut(document, context, Undo{});
  EXPECT_EQ(document.text(), before);
  carryOut(document, context, Redo{});
  EXPECT_NE(document.text(), before);
}

}  // namespace
}  // namespace weir::view::test
