// `weir render --animate`: which moment a frame shows, what the headers say of it, and what is refused.
#include <cmath>

#include "cli/program.h"

namespace weir::test {
namespace {

const std::string moving = sourcePath("scenes/cornell-moving.glb");

TEST_F(Program, AnimationFlags) {
  const std::string start = "render " + allLights + " --scene ";
  expectRefused(start + cornell + " --animate", "has no animations");
  const struct {
    std::string arguments, words;
  } cases[] = {{"--animate --clip blok", "did you mean \"block\"?"},
               {"--animate --clip 5", "has no such clip"},
               {"--clip block", "--animate"},
               {"--time 1", "--animate"},
               {"--time-step 1", "--animate"},
               {"--animate --time -1", "--time"},
               {"--animate --time-step -1", "--time-step"},
               {"--animate --time soon", "--time"}};
  for (const auto& c : cases) expectRefused(start + moving + " " + c.arguments, c.words);
}

// The same moment by a later frame, by a later start, and after frames of a graph without history: the same picture,
// since time, random numbers and jitter are all functions of the frame's number.
TEST_F(Program, AFrameShowsItsMomentHoweverOneGetsThere) {
  const std::string clip = "--animate --clip 0 --time 0.2 --time-step 0.15 --set gbuffer.jitter=true ";
  const image::Picture alone = radiance(allLights, moving, clip + "--first-frame 4", "alone.exr");
  radiance(allLights, moving, clip + "--frames 5", "sequence.exr");
  EXPECT_EQ(alone.rgba, image::readExr(file("sequence.exr")).rgba);
  EXPECT_EQ(alone.attributes.at("weir.animation"), "everything at 0.8 s");
  const image::Picture held =
      radiance(allLights, moving, "--animate --time 0.8 --time-step 0 --set gbuffer.jitter=true --first-frame 4");
  EXPECT_EQ(held.attributes.at("weir.animation"), "everything at 0.8 s");
  double most = 0.0;
  for (size_t i = 0; i < held.rgba.size(); ++i)
    most = std::max(most, std::abs(static_cast<double>(held.rgba[i]) - alone.rgba[i]));
  EXPECT_LT(most, 1e-3 * meanOf(alone)) << "0.2 + 4 · 0.15 and 0.8 differ by rounding";
  // A clip of two seconds starts over.
  const image::Picture later = radiance(allLights, moving, "--animate --time 4.25");
  EXPECT_EQ(later.attributes.at("weir.animation"), "everything at 0.25 s");
  const image::Picture mean = radiance(allLights, moving, "--animate --time-step 0.5 --frames 3 --average 2");
  EXPECT_EQ(mean.attributes.at("weir.animation"), "everything from 0.5 to 1 s");
}

TEST_F(Program, PicturesOfDifferentMomentsAreNotCompared) {
  radiance(allLights, moving, "--animate --time 0.5", "a.exr");
  radiance(allLights, moving, "--animate --time 0.6", "b.exr");
  radiance(allLights, moving, "", "rest.exr");
  for (const auto& [other, words] : {std::pair("b.exr", "everything at 0.6 s"), {"rest.exr", "weir.animation"}}) {
    const Ran r = weir("compare " + file("a.exr") + " " + file(other));
    EXPECT_EQ(r.status, 2);
    EXPECT_TRUE(has(r.err, words)) << r.err;
  }
}

// At rest the moving arrangement and the merged one are the same scene.
TEST_F(Program, TheFirstMomentIsTheSceneAtRest) {
  const image::Picture rest = radiance(allLights, moving, "--set direct.samples=2"),
                       playing = radiance(allLights, moving, "--animate --set direct.samples=2");
  EXPECT_NEAR(meanOf(playing) / meanOf(rest), 1.0, 0.01);
}

}  // namespace
}  // namespace weir::test
