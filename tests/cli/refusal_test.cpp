// Bad input is said clearly: exit status 2, what is wrong and what was meant on stderr, and nothing half-written.
#include "cli/program.h"

namespace weir::test {
namespace {

TEST_F(Program, FlagsOfRender) {
  const std::string start = "render " + allLights + " --scene " + cornell + " ";
  const struct {
    std::string arguments, words;
  } cases[] = {
      {"--sise 8x8", "'--size'"},
      {"--size 8by8", "8by8"},
      {"--size 0x8", "--size 0x8"},
      {"--size 8x", "WIDTHxHEIGHT"},
      {"--size 99999x8", "16384"},
      {"--frames 0", "--frames"},
      {"--frames -1", "--frames"},
      {"--restarts 0", "--restarts"},
      {"--frames 2 --average 3", "--average 3"},
      {"--average 0", "--average 0"},
      {"--trace lamp", "auto, pipeline, query"},
      {"--camera 1,2,3", "ex,ey,ez,tx,ty,tz"},
      {"--camera 1,2,3,1,2,3", "same point"},
      {"--camera 1,2,3,0,0,0,180", "field of view"},
      {"--camera mian", "did you mean \"main\"?"},
      {"--lights 5", "--replace-lights"},
      {"--replace-lights", "--lights"},
      {"--lights many", "--lights"},
      {"--environment none.hdr", "none.hdr"},
      {"--environment " + cornell, "neither an OpenEXR nor a Radiance"},
      {"--environment " + sourcePath("docs/images/demo.png"), "expected radiance"},
      {"--environment-scale 2", "need --environment"},
      {"--environment " + sourcePath("scenes/sky.hdr") + " --environment-scale -1", "--environment-scale"},
      {"--environment " + sourcePath("scenes/sky.hdr") + " --environment-rotation inf", "--environment-rotation"},
      {"--set direct.sample=2", "nearest: 'samples'"},
      {"--set direct.samples=17", "1 to 16"},
      {"--set direct.samples", "--set"},
      {"--set dirct.samples=2", "'direct'"},
      {"--disable direct", "can't be disabled"},
      {"--enable nothing", "no pass 'nothing'"},
      {"--device voodoo", "voodoo"},
      {"--device 99", "99"},
      {"--out radiance", "output=file.exr"},
      {"--out =x.exr", "output=file.exr"},
  };
  for (const auto& c : cases) expectRefused(start + c.arguments, c.words);
  expectRefused("render " + allLights, "--scene");
  expectRefused("rendr", "'render'");
}

TEST_F(Program, Outputs) {
  const std::string start = "render " + allLights + " --size 8x8 --scene " + cornell + " --out ";
  expectRefused(start + "radianc=" + file("a.exr"), "nearest: 'radiance'");
  expectRefused(start + "radiance=" + file("a.jpg"), ".exr or .png");
  expectRefused(start + "radiance=" + file("a.exr") + " --stderr radiance=" + file("b.exr"), "--restarts");
  expectRefused(start + "radiance=" + file("a.exr") + " --restarts 2 --stderr radiance=" + file("b.png"), ".exr");
  // One bad place is found before the good one is written.
  expectRefused(start + "radiance=" + file("a.exr") + " --out color=/nowhere/at/all/b.png", "/nowhere/at/all");
  expectRefused(start + "radiance=" + file("a.exr") + " --stats /nowhere/at/all/b.json", "/nowhere/at/all");
  expectRefused(start + "radiance=" + sourcePath("LICENSE/a.exr"), "LICENSE");
  fs::create_directory(file("taken.exr"));
  const Ran taken = weir(start + "radiance=" + file("taken.exr"));
  EXPECT_EQ(taken.status, 2) << taken.err;
  EXPECT_TRUE(has(taken.err, "taken.exr")) << taken.err;
}

TEST_F(Program, Scenes) {
  const std::string start = "render " + allLights + " --size 8x8 --out radiance=" + file("a.exr") + " --scene ";
  expectRefused(start + file("none.glb"), "none.glb");
  TemporaryFolder bad;
  const std::string whole = read(cornell);
  expectRefused(start + bad.write("cut.glb", whole.substr(0, whole.size() / 2)), "cut.glb");
  expectRefused(start + bad.write("noise.glb", "glTF\2\0\0\0 and then nothing"), "noise.glb");
  expectRefused(start + bad.write("empty.gltf", ""), "empty.gltf");
  expectRefused(start + bad.write("list.gltf", "[1, 2, 3]"), "list.gltf");
  expectRefused(
      start + bad.write("needs.gltf", R"({"asset": {"version": "2.0"}, "extensionsRequired": ["EXT_wishes"]})"),
      "EXT_wishes");
  expectRefused("scene " + bad.path() + "/cut.glb --json", "cut.glb");
}

TEST_F(Program, GraphsThatCanNotBeRead) {
  const std::string end = " --size 8x8 --scene " + cornell + " --out radiance=" + file("a.exr");
  TemporaryFolder bad;
  expectRefused("render " + file("none.json") + end, "none.json");
  expectRefused("render " + bad.write("cut.json", "{\"version\": 1,\n \"passes\": {") + end, "cut.json:2");
  expectRefused("render " + bad.write("none.json", R"({"version": 1, "passes": {}})") + end, "none.json");
}

TEST_F(Program, SixFaultsInOneFileAreSixDiagnostics) {
  // An unknown key, a misspelt pass, a misspelt port, a cycle, a misspelt parameter, a bad value: where they stand and
  // what was meant.
  const struct {
    const char *place, *words;
  } expected[] = {{":3: nmae", "nearest: 'name'"},
                  {":7: passes.initial.inputs.surface", "nearest: 'gbuffer'"},
                  {":11: passes.temporal.inputs.motion", "nearest: 'motion'"},
                  {":14: passes.temporal.inputs.history", "spatial.reservoirs@previous"},
                  {":18: passes.spatial.params.neighbors", "nearest: 'neighbours'"},
                  {":19: passes.spatial.params.radius", "a number from"}};
  const std::string graph = sourcePath("tests/graph/files/six_faults.json");
  for (const std::string& command :
       {"graph check " + graph, "render " + graph + " --scene " + cornell + " --out color=" + file("a.png")}) {
    const Ran r = weir(command);
    EXPECT_EQ(r.status, 2);
    EXPECT_EQ(r.out, "");
    EXPECT_TRUE(fs::is_empty(folder.path()));
    EXPECT_EQ(std::ranges::count(r.err, '\n'), 6) << r.err;
    std::istringstream lines(r.err);
    std::string line;
    for (const auto& e : expected) {
      ASSERT_TRUE(std::getline(lines, line));
      EXPECT_TRUE(has(line, "six_faults.json" + std::string(e.place)) && has(line, e.words)) << line;
    }
  }
}

}  // namespace
}  // namespace weir::test
