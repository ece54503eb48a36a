// What a bench is asked to do: sweeps, plans, the command that measures one point again.
#include <gtest/gtest.h>
#include <weir/core/error.h>
#include <weir/graph/diagnostic.h>
#include <weir/render/bench_command.h>
#include <weir/render/bench_pictures.h>
#include <weir/render/bench_plan.h>
#include <weir/render/bench_sweep.h>

#include <set>
#include <span>

#include "support/device.h"
#include "support/pass_test.h"

namespace weir::render {
namespace {

using test::sourcePath;
using test::TemporaryFolder;

template <typename Work>
std::string refusal(const Work& work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return "not refused";
}

bool has(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

BenchPart restir() {
  BenchPart part;
  part.graphs = {sourcePath("graphs/restir_di.json")};
  part.stage.scene = sourcePath("scenes/cornell.glb");
  part.width = part.height = 16;
  return part;
}

TEST(Sweep, IsReadFromItsText) {
  const Sweep sweep = parseSweep("initial.candidates=8,32,128");
  EXPECT_EQ(sweep.name(), "initial.candidates");
  EXPECT_EQ(sweep.values, (std::vector<std::string>{"8", "32", "128"}));
  EXPECT_FALSE(sweep.isToggle());
  EXPECT_TRUE(parseSweep("spatial.enabled=true,false").isToggle());
  for (const char* text : {"", "a", "a.b", "a=1", ".b=1", "a.=1", "a.b=", "a.b=1,", "a.b=,1", "a.b=1,,2", "=", ".="})
    EXPECT_TRUE(has(refusal([&] { parseSweep(text); }), "--sweep")) << text;
  EXPECT_TRUE(has(refusal([] { parseSweep("a.b=1,2,1"); }), "the value 1 is there twice"));
  EXPECT_TRUE(has(refusal([] { parseSweep("a.enabled=yes"); }), "neither true nor false"));
}

TEST(Sweep, MakesEveryCombinationWithTypedSettings) {
  Laboratory laboratory({});
  BenchPart part = restir();
  part.overrides.set = {"spatial.neighbours=3"};
  part.sweeps = {parseSweep("initial.candidates=8,32"), parseSweep("spatial.enabled=true,false"),
                 parseSweep("temporal.mis=z,pairwise")};
  const std::vector<Configuration> all = expand(laboratory, {part});
  ASSERT_EQ(all.size(), 8u);
  std::set<std::string> labels;
  for (const Configuration& c : all) labels.insert(c.label);
  EXPECT_EQ(labels.size(), 8u);
  EXPECT_EQ(all[1].label, "restir_di.json initial.candidates=8 spatial.enabled=true temporal.mis=pairwise");
  EXPECT_EQ(std::get<int32_t>(all[0].settings.at("initial.candidates")), 8);
  EXPECT_EQ(std::get<int32_t>(all[0].settings.at("spatial.neighbours")), 3);
  EXPECT_EQ(std::get<std::string>(all[0].settings.at("temporal.mis")), "z");
  EXPECT_FALSE(std::get<bool>(all[2].settings.at("spatial.enabled")));
  EXPECT_FALSE(std::get<bool>(all[2].parameters.at("spatial.enabled")));
  EXPECT_FALSE(all[2].parameters.contains("spatial.radius"));
  EXPECT_EQ(all[2].compiled.passes.size() + 1, all[0].compiled.passes.size());
  EXPECT_EQ(std::get<int32_t>(all[4].compiled.passes[1].params.at("candidates")), 32);
}

TEST(Sweep, OfWhatAGraphLacksIsRefusedWithTheNearestName) {
  Laboratory laboratory({});
  const auto refused = [&](const std::vector<std::string>& sweeps, const graph::Overrides& overrides = {}) {
    BenchPart part = restir();
    part.overrides = overrides;
    for (const std::string& text : sweeps) part.sweeps.push_back(parseSweep(text));
    return refusal([&] { expand(laboratory, {part}); });
  };
  EXPECT_TRUE(has(refused({"spatail.radius=1"}), "nearest: 'spatial'"));
  EXPECT_TRUE(has(refused({"spatial.neighbors=1"}), "nearest: 'neighbours'"));
  EXPECT_TRUE(has(refused({"spatial.enable=true"}), "nearest: 'enabled'"));
  EXPECT_TRUE(has(refused({"spatial.radius=1", "spatial.radius=2"}), "given twice"));
  EXPECT_TRUE(has(refused({"spatial.radius=1"}, {.set = {"spatial.radius=2"}}), "only one of them"));
  EXPECT_TRUE(has(refused({"spatial.enabled=true"}, {.disable = {"spatial"}}), "only one of them"));
  EXPECT_TRUE(has(refused({"initial.candidates=8,banana"}), "banana"));
  EXPECT_TRUE(has(refused({"gbuffer.enabled=false,true"}), "gbuffer"));
  // One slip in four configurations is said once.
  const std::string text = refused({"initial.candidates=-1", "spatial.neighbours=1,2,3,4"});
  const std::string place = "passes.initial.params.candidates";
  EXPECT_TRUE(has(text, place)) << text;
  EXPECT_EQ(text.find(place), text.rfind(place)) << text;
  std::string many = "spatial.radius=1";
  for (int i = 2; i < 500; ++i) many += "," + std::to_string(i);
  EXPECT_TRUE(has(refused({many, "temporal.confidenceCap=1,2,3,4,5,6,7,8,9", "initial.candidates=1,2,3,4,5,6,7,8,9",
                           "spatial.neighbours=1,2,3,4"}),
                  "combinations"));
}

std::string planRefusal(const std::string& text) {
  const TemporaryFolder folder;
  const std::string file = folder.write("plan.json", text);
  return refusal([&] { loadBenchPlan(file); });
}

TEST(Plan, IsReadWithItsPaths) {
  const TemporaryFolder folder;
  const std::string file = folder.write("plans/p.json", R"({ "version": 1, "size": "64x32", "frames": 7, "warmup": 0,
    "repeats": 3, "errorFrames": 9, "errorEvery": 2, "flip": false, "crop": [1, 2, 3, 4], "seed": 5,
    "reference": { "graph": "../graphs/all.json", "set": { "direct.x": 1 }, "frames": 2 },
    "sweeps": [ { "name": "a", "graphs": ["../graphs/g.json"], "scene": "s.glb", "lights": 500, "camera": "c",
                  "set": { "x.y": 0.5, "x.z": true }, "sweep": { "p.q": [1, 2.5, "t"], "p.enabled": [true, false] } },
                { "name": "b", "graphs": ["h.json"], "scene": "/abs/s.glb", "size": "8x8",
                  "reference": { "file": "r.exr", "exact": true } } ],
    "tables": [ { "name": "1", "title": "t", "sweep": "a", "knobs": ["p.q"], "published": { "1": 9.8 } } ] })");
  const BenchPlan plan = loadBenchPlan(file, "/scenes");
  ASSERT_EQ(plan.parts.size(), 2u);
  const BenchPart &a = plan.parts[0], &b = plan.parts[1];
  EXPECT_EQ(a.graphs.at(0), folder.path() + "/graphs/g.json");
  EXPECT_EQ(a.stage.scene, "/scenes/s.glb");
  EXPECT_EQ(a.stage.lights, 500u);
  EXPECT_EQ(a.overrides.set, (std::vector<std::string>{"x.y=0.5", "x.z=true"}));
  EXPECT_EQ(a.sweeps.at(0).values, (std::vector<std::string>{"1", "2.5", "t"}));
  EXPECT_EQ(a.width, 64u);
  EXPECT_EQ(a.reference.graph, folder.path() + "/graphs/all.json");
  EXPECT_EQ(a.reference.overrides.set.at(0), "direct.x=1");
  EXPECT_EQ(b.height, 8u);
  EXPECT_EQ(b.stage.scene, "/abs/s.glb");
  EXPECT_EQ(b.reference.file, "/scenes/r.exr");
  EXPECT_TRUE(b.reference.graph.empty());
  EXPECT_EQ(plan.settings.errorEvery, 2u);
  EXPECT_FALSE(plan.settings.flip);
  EXPECT_EQ(plan.settings.crop, (Crop{1, 2, 3, 4}));
  EXPECT_EQ(plan.tables.at(0).published.at("1"), 9.8);
  EXPECT_EQ(loadBenchPlan(file).parts[0].stage.scene, folder.path() + "/plans/s.glb");
}

TEST(Plan, SaysWhatIsWrongWithLineAndNearestName) {
  EXPECT_TRUE(has(planRefusal(""), "not valid JSON"));
  EXPECT_TRUE(has(planRefusal("[]"), "must be a JSON object"));
  EXPECT_TRUE(has(planRefusal("{}"), "sweeps: is missing"));
  EXPECT_TRUE(has(planRefusal(R"({"version": 2, "sweeps": []})"), "version: is 2"));
  EXPECT_TRUE(has(planRefusal("{\"version\": 1,\n \"sweps\": []}"), "plan.json:2: sweps: unknown key"));
  EXPECT_TRUE(has(planRefusal(R"({"version": 1, "sweps": []})"), "nearest: 'sweeps'"));
  EXPECT_TRUE(has(planRefusal(R"({"version": 1, "frames": -1, "sweeps": []})"), "frames: is -1"));
  EXPECT_TRUE(has(planRefusal(R"({"version": 1, "frames": "x", "sweeps": []})"), "expected an integer"));
  EXPECT_TRUE(has(planRefusal(R"({"version": 1, "sweeps": {}})"), "expected an array"));
  EXPECT_TRUE(has(planRefusal(R"({"version": 1, "sweeps": [3]})"), "sweeps[0]: a sweep must be"));
  EXPECT_TRUE(has(planRefusal(R"({"version": 1, "sweeps": [{}]})"), "sweeps[0].graphs: is missing"));
  const auto one = [](const std::string& more) {
    return planRefusal(R"({"version": 1, "sweeps": [{"name": "a", "graphs": ["g"], "scene": "s", )" + more + "}]}");
  };
  EXPECT_TRUE(has(one(R"("sweep": {"q": [1]})"), "pass.param"));
  EXPECT_TRUE(has(one(R"("sweep": {"p.q": []})"), "has no values"));
  EXPECT_TRUE(has(one(R"("sweep": {"p.q": [[1]]})"), "expected a value of a parameter"));
  EXPECT_TRUE(has(one(R"("sweep": {"p.enabled": [1]})"), "neither true nor false"));
  EXPECT_TRUE(has(one(R"("reference": {})"), "either \"file\" or \"graph\""));
  EXPECT_TRUE(has(one(R"("size": "12")"), "is no size"));
  EXPECT_TRUE(
      has(planRefusal(R"({"version": 1, "sweeps": [], "tables": [{"sweep": "x", "knobs": ["k"]}]})"), "no sweep 'x'"));
  EXPECT_TRUE(has(planRefusal(R"({"version": 1, "crop": [1], "sweeps": []})"), "[x, y, width, height]"));
  std::string many = "[0";
  for (int i = 0; i < 100'001; ++i) many += ",0";
  EXPECT_TRUE(has(planRefusal(R"({"version": 1, "sweeps": )" + many + "]}"), "elements of arrays"));
  EXPECT_TRUE(has(planRefusal(std::string(100'000, '[')), "nested deeper"));
}

TEST(Plan, OfTheThesisIsFreeOfFindings) {
  const BenchPlan plan = loadBenchPlan(sourcePath("bench/thesis.json"), "/scenes");
  EXPECT_GE(plan.tables.size(), 12u);
  Laboratory laboratory({});
  std::set<std::string> different;
  for (const Configuration& c : expand(laboratory, plan.parts)) {
    std::string key = plan.parts[c.part].stage.scene;
    for (const auto& [name, value] : c.parameters) key += " " + name + "=" + toText(value);
    different.insert(key);
  }
  EXPECT_GE(different.size(), 100u);
  for (const BenchPart& part : plan.parts) EXPECT_EQ(part.width, 1920u);
}

TEST(Settings, ThatMakeNoSenseAreRefused) {
  const auto refused = [](const BenchSettings& s) { return refusal([&] { checkSettings(s); }); };
  EXPECT_EQ(refused({}), "not refused");
  EXPECT_TRUE(has(refused({.frames = 0}), "--frames 0"));
  EXPECT_TRUE(has(refused({.warmup = UINT32_MAX}), "--warmup"));
  EXPECT_TRUE(has(refused({.repeats = 0}), "--repeats"));
  EXPECT_TRUE(has(refused({.repeats = 65}), "--repeats"));
  EXPECT_TRUE(has(refused({.errorFrames = 4, .errorEvery = 5}), "--error-every"));
  EXPECT_TRUE(has(refused({.firstFrame = UINT32_MAX}), "--first-frame"));
}

TEST(Command, IsQuotedForAShell) {
  BenchOptions o;
  o.parts = {restir()};
  o.parts[0].stage.scene = "it's a scene.glb";
  o.parts[0].stage.camera = "-1,2,3,0,0,0";
  o.parts[0].reference.graph = "all.json";
  Configuration c;
  c.graph = "g.json";
  c.overrides = {{"a.b=x y"}, {}, {"spatial"}};
  const std::string text = benchCommand(c, o);
  EXPECT_TRUE(text.starts_with("weir bench g.json --scene='it'\\''s a scene.glb' --camera=-1,2,3,0,0,0 --size=16x16"))
      << text;
  EXPECT_TRUE(has(text, "--set='a.b=x y' --disable=spatial")) << text;
  EXPECT_TRUE(has(text, "--reference-graph=all.json --repeats=4")) << text;
}

TEST(Pictures, AreCropsInsideOfTheFrame) {
  EXPECT_EQ(cropOf({}, 1920, 1080), (Crop{832, 412, 256, 256}));
  EXPECT_EQ(cropOf({}, 64, 300), (Crop{0, 22, 64, 256}));
  EXPECT_EQ(cropOf(Crop{1, 2, 3, 4}, 4, 6), (Crop{1, 2, 3, 4}));
  for (const Crop& bad : {Crop{0, 0, 0, 1}, Crop{1, 0, 4, 1}, Crop{0, 0, 1, 7}, Crop{UINT32_MAX, 0, 2, 1}})
    EXPECT_TRUE(has(refusal([&] { cropOf(bad, 4, 6); }), "--crop"));
  image::Picture p{4, 2, std::vector<float>(32), {}};
  for (size_t i = 0; i < 32; ++i) p.rgba[i] = static_cast<float>(i);
  const image::Picture part = cropped(p, {1, 1, 2, 1});
  EXPECT_EQ(part.rgba, (std::vector<float>{20, 21, 22, 23, 24, 25, 26, 27}));
  EXPECT_EQ(displayScale(image::Picture{1, 1, {0, 0, 0, 1}, {}}), 1.0f);
  EXPECT_EQ(displayScale(image::Picture{1, 1, {1, 4, 2, 1}, {}}), 0.25f);
  const std::vector<float> flip{0.0f, 1.0f, NAN};
  const image::Picture map = heatMap(std::span(flip).first(2), 2, {0, 0, 2, 1});
  EXPECT_LT(map.rgba[0], 0.01f);
  EXPECT_GT(map.rgba[4], 0.98f);
}

}  // namespace
}  // namespace weir::render
