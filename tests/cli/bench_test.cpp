// `weir bench` asked for what makes no sense, and what its files hold of what it printed. tests/cli/bench_check.py has
// whole runs.
#include "cli/program.h"

namespace weir::test {
namespace {

using Json = nlohmann::json;

class Bench : public Program {
 protected:
  std::string start(const std::string& graph = "", const std::string& counts = "--size 8x8 --frames 1") const {
    return "bench " + (graph.empty() ? restir : graph) + " --scene " + cornell + " --device " + deviceChoice() +
           " --warmup 0 " + counts + " ";
  }
  std::string out() const { return "--out " + file("b.json") + " "; }
  TemporaryFolder inputs;
};

TEST_F(Bench, RefusesWhatItLacks) {
  expectRefused("bench", "--out FILE.json is required");
  expectRefused("bench " + out(), "no graph is named");
  expectRefused("bench " + restir + " " + out(), "--scene is required");
  expectRefused(start() + "--out " + file("b.txt"), "must end in .json");
  expectRefused(start() + "--out " + file("none/b.json"), "no folder");
  expectRefused(start(file("none.json")) + out(), "none.json");
  expectRefused(start() + out() + "--set spatail.radius=1", "nearest: 'spatial'");
  expectRefused(start() + out() + "--sweep spatial.radios=1", "nearest: 'radius'");
  expectRefused(start() + out() + "--sweep spatial=1", "--sweep 'spatial=1'");
  expectRefused(start() + out() + "--sweeps a.b=1", "nearest is '--sweep'");
  expectRefused(start() + out() + "--scenes " + folder.path(), "--scenes needs --plan");
}

TEST_F(Bench, RefusesNumbersThatMakeNoSense) {
  for (const char* shard : {"1", "2/2", "0/0", "-1/2", "0/2x", "a/b", "1/", "/2", "0/99999999999"})
    expectRefused(start() + out() + "--shard=" + shard, "counted from 0");
  for (const char* crop : {"1", "0,0,0,0", "0,0,9,1", "-1,0,1,1", "1,2,3,4,5", "0,0,4294967295,4294967295", "x"})
    expectRefused(start() + out() + "--reference-graph " + allLights + " --crop=" + crop, "--crop");
  expectRefused(start("", "--size 8x8 --frames 0") + out(), "--frames 0");
  expectRefused(start("", "--size 8x8 --frames 4294967295") + out(), "--frames 4294967295");
  expectRefused(start() + out() + "--repeats 0", "--repeats 0");
  expectRefused(start() + out() + "--error-every 300", "--error-every 300");
  expectRefused(start() + out() + "--first-frame 4294967295", "--first-frame");
  expectRefused(start("", "--size 0x8") + out(), "--size 0x8");
  expectRefused(start("", "--size 99999x8") + out(), "1 … 16384");
}

TEST_F(Bench, RefusesReferencesThatAreNone) {
  image::Picture small{4, 4, std::vector<float>(64, 1.0f), {}}, nan{8, 8, std::vector<float>(256, NAN), {}};
  const std::string other = inputs.path() + "/small.exr", broken = inputs.path() + "/nan.exr";
  writeExr(other, small);
  writeExr(broken, nan);
  const std::string bench = start() + out();
  expectRefused(bench + "--reference " + other, "4x4 pixels");
  expectRefused(bench + "--reference " + broken, "not finite");
  expectRefused(bench + "--reference " + inputs.path() + "/none.exr", "none.exr");
  expectRefused(bench + "--reference " + other + " --reference-graph " + allLights, "only one of them");
  expectRefused(bench + "--reference-exact", "needs --reference");
  expectRefused(bench + "--reference-set gbuffer.jitter=true", "need --reference-graph");
  expectRefused(bench + "--reference-graph " + allLights + " --reference-set gbuffr.jitter=true", "gbuffer");
  expectRefused(bench + "--reference-graph " + allLights + " --output colour", "nearest: 'color'");
  expectRefused(bench + "--reference-graph " + allLights + " --animate", "--animate");
  // A picture of something else says so in its header.
  image::Picture elsewhere{8, 8, std::vector<float>(256, 1.0f), {}};
  elsewhere.attributes["weir.scene"] = "other.glb 0123456789abcdef";
  writeExr(other, elsewhere);
  expectRefused(bench + "--reference " + other, "shows something else");
}

TEST_F(Bench, NeverWritesOverWhatItReadsOrWhatIsNoBenchFile) {
  const std::string graph = inputs.write("g.json", read(restir));
  expectRefused(start(graph) + "--out " + graph, "which the graph reads");
  EXPECT_EQ(read(graph), read(restir));
  const std::string foreign = inputs.write("foreign.json", "{\"mine\": 1}");
  expectRefused(start() + "--out " + foreign, "is no bench file");
  EXPECT_EQ(read(foreign), "{\"mine\": 1}");
  inputs.write("p.pictures", "");
  expectRefused(start() + "--out " + inputs.path() + "/p.json", "that is no folder");
}

TEST_F(Bench, RefusesPlansAndMergesThatAreNone) {
  const std::string plan = inputs.write("plan.json", "{\"version\": 1,\n\"swep\": []}");
  expectRefused("bench --plan " + plan + " " + out(), "plan.json:2: swep: unknown key");
  expectRefused("bench --plan " + plan + " --scene " + cornell + " " + out(), "--scene and --plan");
  expectRefused("bench --plan " + inputs.path() + "/none.json " + out(), "can't be read");
  expectRefused("bench --plan " + inputs.path() + " " + out(), "is a folder");
  expectRefused("bench merge " + plan + " --out " + file("m.json"), "is no bench file");
  expectRefused("bench merge --out " + file("m.json"), "files");
  expectRefused("bench merge " + plan + " --out " + file("m.txt"), "must end in .json");
  expectRefused("bench --frames 3 merge " + plan + " --out " + file("m.json"), "takes no --frames");
  expectRefused("bench " + restir + " tables " + plan + " --plan " + plan, "takes no graph");
  expectRefused("bench tables " + plan + " --plan " + plan, "unknown key");
}

// A file of another build or device isn't gone on with: its figures wouldn't be comparable.
TEST_F(Bench, GoesOnOnlyWithItsOwnFile) {
  const Ran first = weir(start() + "--sweep initial.candidates=1,2 --shard 0/2 " + out());
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_TRUE(has(first.out, "1 of 1 configurations measured, 0 were there already (shard 0/2)")) << first.out;
  Json j = Json::parse(read(file("b.json")));
  EXPECT_EQ(j.at("configurations").size(), 1u);
  EXPECT_EQ(j.at("plan").at("configurations").size(), 2u);
  EXPECT_EQ(j.at("configurations").at(0).at("settings").at("initial.candidates"), 1);
  j["device"] = "another";
  const std::string other = inputs.write("b.json", j.dump());
  const Ran refused = weir(start() + "--sweep initial.candidates=1,2 --out " + other);
  EXPECT_EQ(refused.status, 2);
  EXPECT_TRUE(has(refused.err, "--fresh starts over")) << refused.err;
  EXPECT_EQ(weir(start() + "--fresh --out " + other).status, 0);
  EXPECT_EQ(Json::parse(read(other)).at("configurations").size(), 1u);
}

// A pass that is off makes its parameters' values one configuration; without a reference there are no errors.
TEST_F(Bench, MeasuresEqualConfigurationsOnce) {
  const Ran r = weir(start() + "--disable spatial --sweep spatial.radius=1,2,3 " + out());
  ASSERT_EQ(r.status, 0) << r.err;
  const Json j = Json::parse(read(file("b.json")));
  ASSERT_EQ(j.at("configurations").size(), 1u);
  EXPECT_FALSE(j.at("configurations").at(0).contains("error"));
  EXPECT_FALSE(j.at("configurations").at(0).contains("pictures"));
  EXPECT_FALSE(fs::exists(file("b.pictures")));
}

}  // namespace
}  // namespace weir::test
