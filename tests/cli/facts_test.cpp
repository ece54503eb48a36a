// Commands that tell about graphs, passes, scenes, devices and pictures.
#include <set>

#include "cli/program.h"

namespace weir::test {
namespace {

using Json = nlohmann::json;

TEST_F(Program, GraphsOfTheHouseAreSound) {
  size_t graphs = 0;
  for (const auto& entry : fs::directory_iterator(sourcePath("graphs"))) {
    if (entry.path().extension() != ".json") continue;
    ++graphs;
    const Ran r = weir("graph check " + entry.path().string());
    EXPECT_EQ(r.status, 0) << r.err;
    EXPECT_TRUE(has(r.out, "no findings")) << r.out;
  }
  EXPECT_GE(graphs, 2u);
}

TEST_F(Program, SeveralGraphsAtOnce) {
  const std::string one = sourcePath("graphs/restir_di.json"), all = sourcePath("graphs/all_lights.json");
  const Ran good = weir("graph explain " + one + " " + all);
  EXPECT_EQ(good.status, 0) << good.err;
  EXPECT_TRUE(has(good.out, "Graph 'restir-di'") && has(good.out, "Graph 'all-lights'")) << good.out;
  const std::string broken =
      folder.write("broken.json", R"({"version": 1, "passes": {"a": {"type": "no.Such"}}, "outputs": {}})");
  const std::string worse = folder.write("worse.json", "{");
  const Ran bad = weir("graph check " + one + " " + broken + " " + worse);
  EXPECT_EQ(bad.status, 2);
  EXPECT_TRUE(has(bad.err, "broken.json") && has(bad.err, "worse.json")) << "the findings of all: " << bad.err;
}

TEST_F(Program, PassesNamesEveryPass) {
  const Ran r = weir("passes --json");
  ASSERT_EQ(r.status, 0) << r.err;
  const Json j = Json::parse(r.out);
  EXPECT_TRUE(j.at("problems").empty()) << j.at("problems");
  std::set<std::string> types;
  for (const Json& pass : j.at("passes")) {
    types.insert(pass.at("type").get<std::string>());
    EXPECT_NE(pass.at("doc"), "") << pass.at("type");
    for (const Json& param : pass.at("params")) {
      EXPECT_TRUE(param.contains("default") && param.contains("unit") && param.contains("doc")) << param;
      const std::string type = param.at("type");
      if (type == "int" || type == "float") {
        EXPECT_TRUE(param.contains("low")) << pass.at("type") << param;
      }
    }
  }
  for (const char* type :
       {"gbuffer.RayTraced", "gbuffer.Raster", "restir_di.Initial", "restir_di.Temporal", "restir_di.Spatial",
        "restir_di.Shade", "output.Tonemap", "output.Accumulate", "reference.AllLights", "reference.PathTracer"}) {
    EXPECT_TRUE(types.contains(type)) << type;
  }
  const Ran text = weir("passes");
  for (const std::string& type : types) EXPECT_TRUE(has(text.out, type)) << type;
}

TEST_F(Program, SceneCounts) {
  const Json box = Json::parse(weir("scene --json " + cornell).out);
  EXPECT_EQ(box.at("triangles").at("emissive"), 2);
  EXPECT_EQ(box.at("triangles").at("instanced"), 32);
  EXPECT_EQ(box.at("lights").at("triangles"), 2);
  EXPECT_EQ(box.at("lights").at("point"), 0);
  EXPECT_EQ(box.at("traits").at("alpha_test"), false);
  EXPECT_EQ(box.at("traits").at("shared_geometry"), false);
  const Json lit = Json::parse(weir("scene --json " + points).out);
  EXPECT_EQ(lit.at("lights").at("point"), 1000);
  EXPECT_EQ(lit.at("traits").at("delta_lights"), true);
  const Json masks = Json::parse(weir("scene --json " + sourcePath("scenes/alpha-mask.glb")).out);
  EXPECT_EQ(masks.at("materials").at("masked"), 2);
  EXPECT_EQ(masks.at("traits").at("alpha_test"), true);
  EXPECT_TRUE(has(weir("scene " + cornell).out, "emissive 2"));
}

TEST_F(Program, Devices) {
  const Ran r = weir("devices --json");
  ASSERT_EQ(r.status, 0) << r.err;
  const Json j = Json::parse(r.out);
  ASSERT_FALSE(j.empty());
  bool cpu = false;
  for (const Json& device : j) {
    EXPECT_TRUE(device.contains("usable") && device.contains("lacks") && device.contains("name")) << device;
    cpu |= device.at("kind") == "cpu" && device.at("usable").get<bool>();
  }
  EXPECT_TRUE(cpu) << "these tests need a software device";
  EXPECT_TRUE(has(weir("devices").out, j[0].at("name").get<std::string>()));
}

TEST_F(Program, CompareOfEqualPicturesIsZero) {
  radiance(allLights, cornell, "", "a.exr");
  const Ran r = weir("compare " + file("a.exr") + " " + file("a.exr") + " --json --tiles 16");
  ASSERT_EQ(r.status, 0) << r.err;
  const Json j = Json::parse(r.out);
  for (const char* figure : {"mse", "relmse", "mape", "relative_bias", "non_finite"})
    EXPECT_EQ(j.at(figure), 0) << figure;
  EXPECT_EQ(j.at("flip").at("mean"), 0);
  EXPECT_EQ(j.at("pixels"), 32 * 24);
}

TEST_F(Program, CompareRefusesPicturesOfOtherThings) {
  radiance(allLights, cornell, "", "a.exr");
  radiance(allLights, points, "", "scene.exr");
  radiance(allLights, cornell, "--camera 0,1,3,0,1,0,40", "camera.exr");
  radiance(allLights, cornell, "--lights 3 --replace-lights", "lights.exr");
  for (const char* what : {"scene", "camera", "lights"}) {
    const std::string pair = file("a.exr") + " " + file(std::string(what) + ".exr");
    const Ran r = weir("compare " + pair);
    EXPECT_EQ(r.status, 2) << what;
    EXPECT_TRUE(has(r.err, std::string("weir.") + what) && has(r.err, "--force")) << r.err;
    EXPECT_EQ(weir("compare --force " + pair).status, 0) << what;
  }
  EXPECT_EQ(weir("compare " + file("a.exr") + " " + file("none.exr")).status, 2);
}

}  // namespace
}  // namespace weir::test
