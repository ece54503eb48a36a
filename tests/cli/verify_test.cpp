// `weir verify`: verdicts on graphs of which the answer is known, what it refuses, and what it writes.
#include <algorithm>
#include <cmath>

#include "cli/program.h"

namespace weir::test {
namespace {

using Json = nlohmann::json;

class Verify : public Program {
 protected:
  /// A small picture of the Cornell box, 16 fine tiles, under validation, against restarts of the brute-force direct
  /// light.
  Ran verify(const std::string& graph, const std::string& more, uint32_t frames = 1,
             const std::string& scene = "") const {
    return weir("verify " + graph + " --scene " + (scene.empty() ? cornell : scene) + " --device " + deviceChoice() +
                (validationWanted() ? " --validate" : "") + " --size 32x32 --tile 8 --frames " +
                std::to_string(frames) + " " + more);
  }
  std::string rendered() const { return "--reference-graph " + allLights + " "; }
  /// A reference with its standard error, of 64 restarts.
  void renderReference() const {
    const Ran r = weir("render " + allLights + " --scene " + cornell + " --device " + deviceChoice() +
                       " --size 32x32 --restarts 64 --seed 9 --out radiance=" + file("r.exr") +
                       " --stderr radiance=" + file("e.exr"));
    ASSERT_EQ(r.status, 0) << r.err;
  }
  std::string fromFile() const { return "--reference " + file("r.exr") + " --reference-stderr " + file("e.exr") + " "; }
  Json numbers() const { return Json::parse(read(file("v.json"))); }

  const std::string scaled = sourcePath("graphs/template.json");
};

// Seeds are fixed, so that these are the verdicts of one draw each; the chance that a draw alarms falsely is alpha, 1
// %.
TEST_F(Verify, TheReferenceAgainstItselfIsUnbiased) {
  const Ran r = verify(allLights, rendered() + "--json " + file("v.json"));
  EXPECT_EQ(r.status, 0) << r.out << r.err;
  EXPECT_TRUE(has(r.out, "unbiased to 0.")) << r.out;
  const Json j = numbers();
  EXPECT_EQ(j.at("verdict"), "unbiased");
  EXPECT_EQ(j.at("fine").at("tiles").size(), 16u);
  EXPECT_EQ(j.at("coarse").at("tiles").size(), 1u);
  // Another sample of the same, not the same sample: seeds of its own.
  EXPECT_NE(j.at("whole").at("mean"), j.at("whole").at("reference"));
  EXPECT_LE(j.at("within").get<double>(), 0.005);
}

TEST_F(Verify, ReuseWithVisibilityIsUnbiasedAndWithoutIsNot) {
  const std::string
      unbiased =
          "--set temporal.mis=pairwise --set spatial.mis=pairwise --set temporal.visibilityRays=true --set "
          "spatial.visibilityRays=true ",
      biased = "--set temporal.mis=biased --set spatial.mis=biased ", tolerance = "--tolerance 0.03 ";
  const Ran good = verify(restir, rendered() + unbiased + tolerance, 2);
  EXPECT_EQ(good.status, 0) << good.out << good.err;
  const Ran bad = verify(restir, rendered() + biased + tolerance, 2);
  EXPECT_EQ(bad.status, 1) << bad.out << bad.err;
}

// Without a reference direct light is the truth: light that bounces is too much.
TEST_F(Verify, DirectLightIsTheDefaultReference) {
  const Ran direct = verify(allLights, "--restarts 32 --tolerance 0.02");
  EXPECT_EQ(direct.status, 0) << direct.out << direct.err;
  EXPECT_TRUE(has(direct.out, "reference.json")) << direct.out;
  const std::string path = sourcePath("graphs/reference.json");
  const Ran bounces = verify(path, "--restarts 16 --set path.maxBounces=1 --tolerance 0.5");
  EXPECT_EQ(bounces.status, 1) << bounces.out << bounces.err;
  const Ran both =
      verify(path, "--restarts 16 --set path.maxBounces=1 --tolerance 0.5 --tile-tolerance 10 --reference-graph " +
                       path + " --reference-set path.maxBounces=1");
  EXPECT_EQ(both.status, 0) << both.out << both.err;
}

TEST_F(Verify, HalfAPercentTooBrightIsBiased) {
  const std::string more = rendered() + "--out " + file("map.png") + " --json " + file("v.json");
  const Ran r = verify(scaled, "--set scale.factor=1.005 " + more);
  EXPECT_EQ(r.status, 1) << r.out << r.err;
  EXPECT_TRUE(has(r.out, "biased")) << r.out;
  EXPECT_TRUE(has(r.out, "the whole picture's mean is off by +0.")) << r.out;
  const Json j = numbers();
  // Within the interval, which is narrower than the bias.
  EXPECT_GT(j.at("interval").at(0).get<double>(), 0.0);
  EXPECT_LT(j.at("interval").at(0).get<double>(), 0.005);
  EXPECT_GT(j.at("interval").at(1).get<double>(), 0.005);
  const image::Picture map = image::readPng(file("map.png"));
  EXPECT_EQ(map.width, 66u);
  EXPECT_EQ(map.height, 32u);
  // The same graph with nothing planted.
  EXPECT_EQ(verify(scaled, "--set scale.factor=1 " + rendered()).status, 0);
}

TEST_F(Verify, OneWrongTileIsFound) {
  renderReference();
  EXPECT_EQ(verify(allLights, fromFile()).status, 0);
  image::Picture reference = image::readExr(file("r.exr"));
  for (uint32_t y = 16; y < 24; ++y) {
    for (uint32_t x = 8; x < 16; ++x) {
      for (int c = 0; c < 3; ++c) reference.at(x, y)[c] *= 1.1f;
    }
  }
  image::writeExr(file("r.exr"), reference);
  const Ran r = verify(allLights, fromFile() + "--json " + file("v.json") + " --out " + file("d.exr"));
  EXPECT_EQ(r.status, 1) << r.out << r.err;
  EXPECT_TRUE(has(r.out, "1 of 16 tiles of 8² are off, most surely that at 8, 16: -")) << r.out;
  EXPECT_EQ(numbers().at("fine").at("alarms"), Json::parse("[[8, 16]]"));
  // What was planted is 1/1.1 - 1 = -9.1 %; the tile's error is some 1.4 %.
  EXPECT_NEAR(numbers().at("fine").at("tiles").at(9).at("relative").get<double>(), -0.091, 0.05);
  const image::Picture difference = image::readExr(file("d.exr"));
  double sum = 0;
  for (uint32_t i = 0; i < 64; ++i) sum += difference.at(8 + i % 8, 16 + i / 8)[1];
  EXPECT_LT(sum, 0.0);
  EXPECT_EQ(difference.attributes.at("weir.verdict"), "biased");
}

TEST_F(Verify, AShortRunIsUndecidedAndSaysHowLongToRun) {
  const Ran r = verify(restir,
                       rendered() +
                           "--set temporal.visibilityRays=true --set spatial.visibilityRays=true --restarts 16 "
                           "--tolerance 0.0005 --json " +
                           file("v.json"),
                       2);
  EXPECT_EQ(r.status, 3) << r.out << r.err;
  EXPECT_TRUE(has(r.out, "undecided")) << r.out;
  EXPECT_TRUE(has(r.out, "run longer: about")) << r.out;
  EXPECT_GT(numbers().at("enough_restarts").get<int>(), 16);
  // Too few restarts to say anything at all.
  const Ran few = verify(scaled, "--set scale.factor=1.005 --restarts 4 " + rendered());
  EXPECT_EQ(few.status, 3) << few.out;
  EXPECT_TRUE(has(few.out, "4 restarts are too few")) << few.out;
}

TEST_F(Verify, GoesOnWhileUndecidedWhenAllowedTo) {
  const Ran r = verify(allLights, rendered() + "--restarts 8 --max-restarts 64 --json " + file("v.json"));
  EXPECT_EQ(r.status, 0) << r.out << r.err;
  const Json j = numbers();
  EXPECT_EQ(j.at("looks"), 4);
  EXPECT_GT(j.at("look").get<int>(), 1);
  EXPECT_EQ(j.at("restarts").get<int>(), 8 << (j.at("look").get<int>() - 1));
  // A look's share of alpha: whole picture half of 0.01 / 4.
  EXPECT_NEAR(j.at("interval_level").get<double>(), 0.00125, 1e-12);
}

TEST_F(Verify, AMovingSceneIsComparedAtItsLastFrame) {
  const std::string moving = sourcePath("scenes/cornell-moving.glb");
  const Ran r =
      verify(allLights, rendered() + "--animate --time 0.3 --time-step 0.1 --json " + file("v.json"), 3, moving);
  EXPECT_EQ(r.status, 0) << r.out << r.err;
  EXPECT_TRUE(has(numbers().at("animation"), "at 0.5 s")) << numbers().at("animation");
}

TEST_F(Verify, AReferenceOfUnknownErrorIsSaidToBe) {
  renderReference();
  const Ran unknown = verify(allLights, "--reference " + file("r.exr"));
  EXPECT_EQ(unknown.status, 0) << unknown.out;
  EXPECT_TRUE(has(unknown.err, "nothing is known of the error")) << unknown.err;
  const Ran exact = verify(allLights, "--reference-exact --reference " + file("r.exr"));
  EXPECT_FALSE(has(exact.err, "nothing is known")) << exact.err;
  EXPECT_TRUE(has(exact.out, "taken as exact")) << exact.out;
}

TEST_F(Verify, VerdictsAreTheSameEveryTime) {
  const std::string more = rendered() + "--restarts 20 --json " + file("v.json");
  verify(allLights, more);
  Json a = numbers();
  verify(allLights, more);
  Json b = numbers();
  for (Json* j : {&a, &b}) {
    j->erase("seconds_per_restart");
    j->at("reference").erase("seconds_per_restart");
  }
  EXPECT_EQ(a, b);
  verify(allLights, more + " --seed 5");
  EXPECT_NE(numbers().at("whole"), a.at("whole"));
}

// However many restarts run at a time; 20 are no multiple of 6.
TEST_F(Verify, VerdictsAreTheSameInAnyNumberOfLanes) {
  const std::string more = rendered() + "--restarts 20 --tolerance 0.05 --json " + file("v.json") + " --lanes ";
  std::vector<Json> all;
  for (const char* lanes : {"1", "6"}) {
    const Ran r = verify(restir, more + lanes, 2);  // whatever the verdict is
    ASSERT_EQ(r.err, "");
    Json j = numbers();
    for (Json* part : {&j, &j.at("reference")}) {
      EXPECT_EQ(part->at("lanes").dump(), lanes);
      part->erase("lanes");
      part->erase("seconds_per_restart");
    }
    all.push_back(j);
  }
  EXPECT_EQ(all[0], all[1]);
}

TEST_F(Verify, RefusesReferencesOfSomethingElse) {
  TemporaryFolder elsewhere;
  const std::string r = elsewhere.path() + "/r.exr", e = elsewhere.path() + "/e.exr";
  const std::string start = "render " + allLights + " --scene " + cornell + " --device " + deviceChoice() +
                            " --size 32x32 --restarts 2 --out radiance=";
  ASSERT_EQ(weir(start + r + " --stderr radiance=" + e).status, 0);
  const std::string verify = "verify " + allLights + " --device " + deviceChoice() +
                             " --restarts 16 --frames 1 --json " + file("v.json") + " --reference " + r + " --scene ";
  expectRefused(verify + cornell + " --size 16x32", "32x32 pixels, --size 16x32");
  expectRefused(verify + cornell + " --size 32x32 --camera 0,1,3,0,1,0", "weir.camera");
  expectRefused(verify + points + " --size 32x32", "weir.scene");
  expectRefused(verify + cornell + " --size 32x32 --lights 3 --replace-lights", "weir.lights");
  expectRefused(verify + sourcePath("scenes/cornell-moving.glb") + " --size 32x32 --animate", "weir.animation");
  image::Picture bad = image::readExr(r);
  bad.at(5, 6)[0] = NAN;
  image::writeExr(r, bad);
  expectRefused(verify + cornell + " --size 32x32", "the first at 5, 6");
}

TEST_F(Verify, RefusesWhatMakesNoSense) {
  const std::string start = "verify " + allLights + " --scene " + cornell + " --size 16x16 --reference-graph " +
                            allLights + " --json " + file("v.json") + " ";
  expectRefused(start + "--output radianc", "nearest: 'radiance'");
  expectRefused(start + "--restarts 1", "--restarts 1");
  expectRefused(start + "--alpha 0", "--alpha 0");
  expectRefused(start + "--tolerance 5", "half a percent");
  expectRefused(start + "--tile 0", "--tile 0");
  expectRefused(start + "--frames 0", "--frames");
  expectRefused(start + "--max-restarts 3", "--max-restarts 3");
  for (const char* lanes : {"0", "65", "1000000", "99999999999999999999", "many", "3.5", "4x", "AUTO"})
    expectRefused(start + "--lanes " + lanes, "--lanes " + std::string(lanes) + ": must be auto or 1 … 64");
  expectRefused(start + "--lanes=-1", "--lanes -1: must be auto or 1 … 64");
  expectRefused(start + "--lanes -1", "--lanes");
  expectRefused(start + "--lanes", "--lanes");
  expectRefused(start + "--reference x.exr", "only one of them");
  expectRefused(start + "--reference-stderr x.exr", "needs --reference");
  expectRefused(start + "--reference-exact", "needs --reference");
  expectRefused(start + "--set direct.sample=3", "nearest: 'samples'");
  expectRefused(start + "--reference-set direct.sample=3", "nearest: 'samples'");
  expectRefused(start + "--out map.jpg", ".png");
  expectRefused(start + "--out /nowhere/map.png", "no folder /nowhere");
  expectRefused(start + "--size 0x4", "--size");
  expectRefused("verify " + allLights + " --scene " + cornell + " --reference " + sourcePath("scenes/cornell.glb"),
                "cornell.glb");
  const Ran help = weir("verify --help");
  EXPECT_EQ(help.status, 0);
  EXPECT_TRUE(has(help.out, "--reference-stderr"));
}

}  // namespace
}  // namespace weir::test
