// `weir verify`, `compare` and `render` asked for what makes no sense, or would write over what they shouldn't.
#include <cmath>

#include "cli/program.h"

namespace weir::test {
namespace {

using Json = nlohmann::json;

class Hostile : public Program {
 protected:
  std::string verifyStart(const std::string& size = "16x16") const {
    return "verify " + allLights + " --scene " + cornell + " --device " + deviceChoice() + " --tile 8 --size " + size +
           " ";
  }
  static image::Picture constant(uint32_t side, float value) {
    image::Picture p{side, side, {}, {}};
    p.rgba.assign(size_t{4} * side * side, value);
    return p;
  }
  /// Written outside of the folder that a refusal must leave empty.
  std::string input(const std::string& name, const image::Picture& picture) const {
    const std::string path = inputs.path() + "/" + name;
    image::writeExr(path, picture);
    return path;
  }
  TemporaryFolder inputs;
};

TEST_F(Hostile, NumbersThatWouldSilenceEverything) {
  const std::string start = verifyStart();
  for (const char* option : {"alpha", "tolerance", "tile-tolerance", "negligible"}) {
    for (const char* value : {"nan", "inf", "-inf", "-1", "1e30"})
      expectRefused(start + "--" + option + "=" + value, "--" + std::string(option) + " ");
  }
}

TEST_F(Hostile, FramesWhoseNumbersWrap) {
  const std::string end = " --first-frame 4294967295 --frames 2";
  expectRefused(verifyStart() + end, "--first-frame 4294967295 with --frames 2");
  expectRefused(verifyStart() + "--first-frame 4294967295 --frames 1 --reference-frames 2", "--reference-frames 2");
  expectRefused("render " + allLights + " --scene " + cornell + " --out radiance=" + file("a.exr") + end,
                "--first-frame 4294967295 with --frames 2");
  const Ran last = render(allLights, cornell, "--first-frame 4294967295 --out radiance=" + file("a.exr"));
  EXPECT_EQ(last.status, 0) << last.err;
}

TEST_F(Hostile, TwoOutputsOfOneName) {
  const std::string a = file("a.exr"), same = folder.path() + "/./a.exr";
  const std::string start = "render " + allLights + " --size 8x8 --scene " + cornell + " ";
  expectRefused(start + "--out radiance=" + a + " --out radiance=" + a, "which --out radiance writes too");
  expectRefused(start + "--out radiance=" + a + " --out radiance=" + same, "writes too");
  expectRefused(start + "--restarts 2 --out radiance=" + a + " --stderr radiance=" + a,
                "--stderr radiance would write");
  expectRefused(start + "--out radiance=" + a + " --stats " + a, "--stats would write");
  expectRefused(verifyStart() + "--out " + a + " --json " + a, "--json would write");
  // And what is read, also through a link.
  const std::string r = input("r.exr", constant(16, 1.0f)), link = inputs.path() + "/link.exr";
  fs::create_symlink(r, link);
  const std::string before = read(r);
  expectRefused(verifyStart() + "--reference " + r + " --json " + r, "which --reference reads");
  expectRefused(verifyStart() + "--reference " + r + " --out " + link, "which --reference reads");
  expectRefused(start + "--stats " + cornell, "which --scene reads");
  expectRefused(start + "--stats " + allLights, "which the graph reads");
  EXPECT_EQ(read(r), before);
}

TEST_F(Hostile, OutputsThatAreNoFiles) {
  TemporaryFolder elsewhere;
  const std::string pipe = elsewhere.path() + "/pipe";
  ASSERT_EQ(std::system(("mkfifo " + pipe).c_str()), 0);
  for (const std::string& path : {std::string("/dev/full"), std::string("/dev/null"), pipe, elsewhere.path()}) {
    expectRefused(verifyStart() + "--json " + path, "can't write " + path);
    expectRefused("render " + allLights + " --scene " + cornell + " --stats " + path, "can't write " + path);
  }
}

// All pixels of a jittered frame share its offset: their errors are not independent.
TEST_F(Hostile, AReferenceFileWhosePixelsMoveTogether) {
  TemporaryFolder elsewhere;
  const std::string r = elsewhere.path() + "/r.exr", e = elsewhere.path() + "/e.exr";
  const Ran rendered =
      weir("render " + allLights + " --scene " + cornell + " --device " + deviceChoice() +
           " --size 16x16 --restarts 2 --set gbuffer.jitter=true --out radiance=" + r + " --stderr radiance=" + e);
  ASSERT_EQ(rendered.status, 0) << rendered.err;
  const std::string words = "--reference-set gbuffer.jitter=true";
  expectRefused(verifyStart() + "--reference " + r + " --reference-stderr " + e, words);
  expectRefused(verifyStart() + "--reference " + r, words);
  // Rendered here, whole restarts are the samples.
  const Ran here = weir(verifyStart() + "--frames 1 --tile-tolerance 10 --tolerance 0.9 --restarts 256 --set " +
                        "gbuffer.jitter=true --reference-graph " + allLights + " " + words);
  EXPECT_EQ(here.status, 0) << here.out << here.err;
}

TEST_F(Hostile, ReferencesThatAreNegativeOrBlack) {
  const std::string start = verifyStart() + "--frames 1 --restarts 16 --json ";
  image::Picture tile = constant(16, 1.0f);
  for (uint32_t i = 0; i < 64; ++i) tile.at(8 + i % 8, i / 8)[1] = -0.5f;
  for (const char* exact : {"", " --reference-exact"}) {
    expectRefused(start + file("v.json") + " --reference " + input("minus.exr", constant(16, -1.0f)) + exact,
                  "is negative: its mean is -1 in R");
    expectRefused(start + file("v.json") + " --reference " + input("tile.exr", tile) + exact, "tile of 8² at 8, 0");
    const Ran black =
        weir(start + inputs.path() + "/v.json --reference " + input("black.exr", constant(16, 0.0f)) + exact);
    EXPECT_EQ(black.status, 3) << black.out << black.err;
    EXPECT_TRUE(has(black.out, "the reference is black")) << black.out;
    EXPECT_FALSE(has(black.out, "inf") || has(black.out, "nan")) << black.out;
    EXPECT_EQ(Json::parse(read(inputs.path() + "/v.json")).at("verdict"), "undecided");
  }
}

TEST_F(Hostile, UnlikeNumbersOfRestartsAreSaid) {
  const Ran r = weir(verifyStart("8x8") + "--frames 1 --restarts 40 --reference-restarts 16 --json " + file("v.json"));
  EXPECT_TRUE(has(r.err, "40 restarts against 16 of the reference")) << r.err;
  const Json j = Json::parse(read(file("v.json")));
  ASSERT_EQ(j.at("warnings").size(), 1u);
  EXPECT_TRUE(has(j.at("warnings").at(0), "40 restarts against 16"));
}

// A verdict against a file of many more restarts may be about light that these have not seen.
TEST_F(Hostile, ABiasAgainstAFileOfManyMoreRestartsIsSaidWithCare) {
  image::Picture picture = constant(16, 100.0f), error = constant(16, 0.01f);
  error.attributes["weir.restarts"] = "64";
  const std::string files =
      "--reference " + input("r.exr", picture) + " --reference-stderr " + input("e.exr", error) + " --frames 1 ";
  const Ran few = weir(verifyStart() + files + "--restarts 16");
  EXPECT_EQ(few.status, 1) << few.out << few.err;
  EXPECT_TRUE(has(few.err, "--restarts 64 tells the two apart")) << few.err;
  const Ran many = weir(verifyStart() + files + "--restarts 32");
  EXPECT_EQ(many.status, 1) << many.out;
  EXPECT_FALSE(has(many.err, "tells the two apart")) << many.err;
}

TEST_F(Hostile, NothingToCompare) {
  const std::string one = input("one.exr", constant(16, 1.0f)), nothing = input("nan.exr", constant(16, NAN));
  expectRefused("compare " + one + " " + nothing, "none of the 256 pixels is finite in both");
  expectRefused("compare --json --tiles 8 " + nothing + " " + one, "none of the 256 pixels");
  for (const float value : {0.0f, -1.0f}) {
    const std::string pair = "compare --no-flip --tiles 8 " + one + " " + input("dark.exr", constant(16, value));
    const Ran table = weir(pair);
    EXPECT_EQ(table.status, 0) << table.err;
    EXPECT_TRUE(has(table.out, "undefined")) << table.out;
    std::string below = table.out.substr(table.out.find('\n'));
    for (size_t at = 0; (at = below.find("non-finite")) != std::string::npos;) below.erase(at, 10);
    EXPECT_FALSE(has(below, "inf") || has(below, "nan")) << table.out;
    const Json j = Json::parse(weir(pair + " --json").out);
    EXPECT_TRUE(j.at("relative_bias").is_null());
    EXPECT_TRUE(j.at("tiles").at("rms_relative").is_null());
    EXPECT_TRUE(j.at("tiles").at("list").at(0).at("relative").is_null());
  }
}

TEST_F(Hostile, HelpStatesExitStatuses) {
  EXPECT_TRUE(has(weir("verify --help").out, "Exit status: 0 unbiased; 1 biased"));
  EXPECT_TRUE(has(weir("compare --help").out, "Exit status: 0 compared"));
}

}  // namespace
}  // namespace weir::test
