// `weir render`: what its flags do to the picture.
#include <weir/render/render.h>

#include <cmath>

#include "cli/program.h"

namespace weir::test {
namespace {

using Json = nlohmann::json;

bool same(const image::Picture& a, const image::Picture& b) {
  return a.rgba == b.rgba;
}

/// Largest difference relative to the first picture's mean.
double apart(const image::Picture& a, const image::Picture& b) {
  double most = 0;
  for (size_t i = 0; i < a.rgba.size() && i < b.rgba.size(); ++i)
    most = std::max(most, std::abs(double(a.rgba[i]) - b.rgba[i]));
  return a.rgba.size() == b.rgba.size() ? most / meanOf(a) : 1e30;
}

TEST_F(Program, HeadersSayWhatThePictureShows) {
  const Ran r =
      render(restir, points, "--frames 3 --average 2 --seed 7 --set spatial.radius=12 --out radiance=" + file("a.exr"));
  ASSERT_EQ(r.status, 0) << r.err;
  EXPECT_TRUE(has(r.out, "a.exr"));
  const image::Picture p = image::readExr(file("a.exr"));
  EXPECT_EQ(p.width, 32u);
  EXPECT_EQ(p.height, 24u);
  const auto says = [&](const char* name, const char* words) {
    ASSERT_TRUE(p.attributes.contains(name)) << name;
    EXPECT_TRUE(has(p.attributes.at(name), words)) << name << ": " << p.attributes.at(name);
  };
  says("weir.scene", "cornell-1000-points.glb");
  says("weir.camera", "eye 0 1 3.9");
  says("weir.lights", "scene");
  says("weir.graph", "restir-di");
  says("weir.params", "spatial.radius=12");
  says("weir.seed", "7");
  says("weir.frames", "3 from 0, mean of last 2");
  EXPECT_GT(meanOf(p), 0.0);
}

TEST_F(Program, SeedsDecideThePicture) {
  radiance(restir, cornell, "--frames 2 --seed 5", "a.exr");
  radiance(restir, cornell, "--frames 2 --seed 5", "b.exr");
  radiance(restir, cornell, "--frames 2 --seed 6", "c.exr");
  EXPECT_EQ(read(file("a.exr")), read(file("b.exr"))) << "byte for byte";
  EXPECT_FALSE(same(image::readExr(file("a.exr")), image::readExr(file("c.exr"))));
}

TEST_F(Program, FramesAreNumberedAndAveraged) {
  const image::Picture one = radiance(allLights, cornell, "--first-frame 1"),
                       two = radiance(allLights, cornell, "--first-frame 2");
  EXPECT_FALSE(same(one, two));
  // Without history a frame is the same wherever the sequence begins.
  EXPECT_TRUE(same(two, radiance(allLights, cornell, "--frames 3")));
  image::Picture mean = one;
  for (size_t i = 0; i < mean.rgba.size(); ++i) mean.rgba[i] = 0.5f * (one.rgba[i] + two.rgba[i]);
  EXPECT_LT(apart(mean, radiance(allLights, cornell, "--frames 3 --average 2")), 1e-5);
}

TEST_F(Program, RestartsAreIndependentSequences) {
  // Two restarts of a graph with history, put together from two runs with the restarts' seeds.
  const std::string frames = "--frames 2 ";
  const image::Picture first =
      radiance(restir, cornell, frames + "--seed " + std::to_string(render::restartSeed(3, 0)));
  const image::Picture second =
      radiance(restir, cornell, frames + "--seed " + std::to_string(render::restartSeed(3, 1)));
  const image::Picture both =
      radiance(restir, cornell, frames + "--seed 3 --restarts 2 --stderr radiance=" + file("e.exr"));
  const image::Picture error = image::readExr(file("e.exr"));
  image::Picture mean = first, expected = first;
  for (size_t i = 0; i < mean.rgba.size(); ++i) {
    mean.rgba[i] = 0.5f * (first.rgba[i] + second.rgba[i]);
    expected.rgba[i] =
        i % 4 == 3 ? error.rgba[i] : 0.5f * std::abs(first.rgba[i] - second.rgba[i]);  // s/√2 of two values
  }
  EXPECT_LT(apart(mean, both), 1e-5);
  EXPECT_LT(apart(expected, error), 1e-4);
}

// The standard error falls with the root of the number of restarts, and says how far two means lie apart. Sampling
// errors of the two figures are about 2 % and 5 %; the bounds are five times as wide.
TEST_F(Program, StandardErrorsAreTrue) {
  const auto run = [&](const std::string& more, const std::string& name) {
    radiance(allLights, cornell, more + " --stderr radiance=" + file(name + "-e.exr"), name + ".exr");
    return std::pair(image::readExr(file(name + ".exr")), image::readExr(file(name + "-e.exr")));
  };
  const auto few = run("--restarts 16 --seed 1", "few"), many = run("--restarts 64 --seed 2", "many"),
             other = run("--restarts 64 --seed 3", "other");
  double sumFew = 0, sumMany = 0, z = 0;
  size_t n = 0;
  for (size_t i = 0; i < many.first.rgba.size(); ++i) {
    const double ea = many.second.rgba[i], eb = other.second.rgba[i];
    if (i % 4 == 3 || !(ea > 0.0) || !(eb > 0.0)) continue;
    sumFew += double(few.second.rgba[i]) * few.second.rgba[i];
    sumMany += ea * ea;
    const double d = double(many.first.rgba[i]) - other.first.rgba[i];
    z += d * d / (ea * ea + eb * eb);
    ++n;
  }
  EXPECT_GT(n, 500u);
  EXPECT_NEAR(sumFew / sumMany, 4.0, 0.6);
  EXPECT_NEAR(z / static_cast<double>(n), 1.0, 0.25);
}

TEST_F(Program, SetEnableAndDisable) {
  const image::Picture plain = radiance(restir, points, "--frames 2");
  EXPECT_FALSE(same(plain, radiance(restir, points, "--frames 2 --set initial.candidates=4")));
  const image::Picture without = radiance(restir, points, "--frames 2 --disable spatial");
  EXPECT_FALSE(same(plain, without));
  // The same pass switched off in the file, and on again by hand.
  Json graph = Json::parse(read(restir));
  graph["passes"]["spatial"]["enabled"] = false;
  const std::string off = folder.write("off.json", graph.dump());
  EXPECT_TRUE(same(without, radiance(off, points, "--frames 2")));
  EXPECT_TRUE(same(plain, radiance(off, points, "--frames 2 --enable spatial")));
}

TEST_F(Program, ExposureReachesTheToneMapAndNothingElse) {
  const std::string outs = " --out radiance=" + file("r.exr") + " --out color=" + file("c.png");
  ASSERT_EQ(render(allLights, cornell, outs).status, 0);
  const image::Picture radiance0 = image::readExr(file("r.exr")), color0 = image::readPng(file("c.png"));
  ASSERT_EQ(render(allLights, cornell, "--exposure 2" + outs).status, 0);
  EXPECT_TRUE(same(radiance0, image::readExr(file("r.exr"))));
  EXPECT_GT(meanOf(image::readPng(file("c.png"))), meanOf(color0) + 0.05);
}

TEST_F(Program, LightsAndCameras) {
  const image::Picture a = radiance(allLights, cornell, "--lights 20 --replace-lights");
  EXPECT_FALSE(same(a, radiance(allLights, cornell, "--lights 20 --replace-lights --light-seed 2")));
  EXPECT_TRUE(same(radiance(allLights, cornell, "--camera main"), radiance(allLights, cornell, "")));
  EXPECT_FALSE(same(radiance(allLights, cornell, "--camera 0,1,3,0,1,0,40"), radiance(allLights, cornell, "")));
  EXPECT_EQ(image::readExr(file("radiance.exr")).attributes.at("weir.lights"), "scene");
}

TEST_F(Program, BothBackEndsMakeThePicture) {
  const image::Picture a = radiance(allLights, cornell, "--trace pipeline"),
                       b = radiance(allLights, cornell, "--trace query");
  EXPECT_NEAR(meanOf(a), meanOf(b), 1e-3 * meanOf(a));
}

// Raster for RayTraced by changing the type alone: the same radiance within 0.1 % but for pixels on silhouettes.
TEST_F(Program, RasterTakesThePlaceOfRayTraced) {
  Json graph = Json::parse(read(allLights));
  graph["passes"]["gbuffer"]["type"] = "gbuffer.Raster";
  const std::string raster = folder.write("raster.json", graph.dump());
  const image::Picture a = radiance(allLights, cornell, ""), b = radiance(raster, cornell, "");
  size_t differ = 0;
  double sumA = 0, sumB = 0;
  for (size_t i = 0; i < a.rgba.size(); i += 4) {
    const double la = a.rgba[i] + a.rgba[i + 1] + a.rgba[i + 2], lb = b.rgba[i] + b.rgba[i + 1] + b.rgba[i + 2];
    if (std::abs(la - lb) > 0.05 * (la + 1e-3)) {
      ++differ;
      continue;
    }
    sumA += la;
    sumB += lb;
  }
  EXPECT_LT(differ, a.rgba.size() / 4 / 20);
  EXPECT_NEAR(sumA, sumB, 1e-3 * sumA);
}

TEST_F(Program, StatisticsAreComplete) {
  ASSERT_EQ(render(restir, points, "--frames 6 --stats " + file("s.json") + " --out radiance=" + file("a.exr")).status,
            0);
  const Json j = Json::parse(read(file("s.json")));
  EXPECT_EQ(j.at("frames"), 6);
  EXPECT_EQ(j.at("size"), Json({32, 24}));
  EXPECT_FALSE(j.at("device").get<std::string>().empty());
  EXPECT_FALSE(j.at("driver").get<std::string>().empty());
  EXPECT_EQ(j.at("passes").size(), 6u);
  for (const Json& pass : j.at("passes")) {
    EXPECT_TRUE(pass.contains("type") && pass.contains("name") && pass.contains("cpu_ms")) << pass;
    EXPECT_GE(pass.at("gpu_ms").at("p99").get<double>(), pass.at("gpu_ms").at("median").get<double>());
  }
  EXPECT_GT(j.at("frame").at("gpu_ms").at("median").get<double>(), 0.0);
  for (const char* bytes : {"transient_bytes", "history_bytes", "scene_bytes"})
    EXPECT_GT(j.at("memory").at(bytes), 0) << bytes;
  // One camera ray and at least one shadow ray for most pixels.
  EXPECT_GT(j.at("rays").get<uint64_t>(), 32u * 24);
}

TEST_F(Program, EnvironmentsLightTheSceneAndAreNamed) {
  const std::string sky = sourcePath("scenes/sky.hdr"), with = "--environment " + sky + " ";
  const image::Picture dark = radiance(allLights, cornell, "", "dark.exr"),
                       lit = radiance(allLights, cornell, with, "lit.exr"),
                       twice = radiance(allLights, cornell, with + "--environment-scale 2", "twice.exr"),
                       turned = radiance(allLights, cornell, with + "--environment-rotation 90", "turned.exr");
  EXPECT_TRUE(has(lit.attributes.at("weir.lights"), "scene, environment sky.hdr "));
  EXPECT_TRUE(has(twice.attributes.at("weir.lights"), " times 2"));
  EXPECT_TRUE(has(turned.attributes.at("weir.lights"), " turned 90 degrees"));
  EXPECT_GT(meanOf(lit), meanOf(dark));
  // Linear, up to the noise of a sample a pixel.
  EXPECT_NEAR((meanOf(twice) - meanOf(dark)) / (meanOf(lit) - meanOf(dark)), 2.0, 0.4);
  EXPECT_FALSE(same(lit, turned));
  const Ran refused = weir("compare " + file("lit.exr") + " " + file("twice.exr"));
  EXPECT_EQ(refused.status, 2);
  EXPECT_TRUE(has(refused.err, "weir.lights")) << refused.err;
}

TEST_F(Program, StatisticsTellOfTheEnvironment) {
  const Ran r = render(restir, cornell,
                       "--environment " + sourcePath("scenes/sky.hdr") + " --stats " + file("s.json") +
                           " --out radiance=" + file("a.exr"));
  ASSERT_EQ(r.status, 0) << r.err;
  const Json j = Json::parse(read(file("s.json")));
  ASSERT_TRUE(j.contains("environment"));
  EXPECT_EQ(j["environment"]["size"], Json({64, 32}));
  EXPECT_GT(j["environment"]["share"], 0.0);
  EXPECT_LT(j["environment"]["share"], 1.0);
  EXPECT_GT(j["environment"]["integral"], 0.0);
}

}  // namespace
}  // namespace weir::test
