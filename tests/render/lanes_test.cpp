// Restarts that run several at a time are, bit by bit and in the same order, those that run one after the other.
#include <gtest/gtest.h>
#include <weir/core/error.h>
#include <weir/render/laboratory.h>
#include <weir/render/lanes.h>

#include <cstring>

#include "support/device.h"

namespace weir::test {
namespace {

using Pictures = std::vector<image::Picture>;

/// What all of them share: a small scene under validation.
class Lanes : public ::testing::Test {
 protected:
  void open(render::StageOptions stage) {
    stage.scene = sourcePath(stage.scene);
    laboratory_.open(stage, {.device = deviceChoice(), .validation = validationWanted()}, 1.0f);
  }
  graph::CompiledGraph compile(const std::string& graph, const std::vector<std::string>& set) {
    return laboratory_.compile(sourcePath("graphs/" + graph), {.set = set, .enable = {}, .disable = {}}, 32, 32);
  }
  /// The pictures of so many restarts, asked for in portions.
  Pictures run(const std::string& graph, const std::vector<std::string>& set, render::RestartOptions options,
               uint32_t lanes, const std::vector<uint32_t>& portions) {
    options.lanes = lanes;
    options.seed = 5;
    render::Restarts restarts(laboratory_, compile(graph, set), options);
    Pictures result;
    uint32_t wanted = 0;
    for (const uint32_t count : portions) {
      restarts.run(
          count, [&](std::span<const image::Picture> some) { result.insert(result.end(), some.begin(), some.end()); });
      EXPECT_EQ(result.size(), wanted += count) << "all are there when run returns";
    }
    EXPECT_EQ(restarts.done(), wanted);
    EXPECT_EQ(restarts.lanes(), lanes);
    return result;
  }
  static bool same(const image::Picture& a, const image::Picture& b) {
    return a.width == b.width && a.height == b.height && a.rgba.size() == b.rgba.size() &&
           std::memcmp(a.rgba.data(), b.rgba.data(), a.rgba.size() * sizeof(float)) == 0;
  }
  static void expectSame(const Pictures& a, const Pictures& b, const std::string& what) {
    ASSERT_EQ(a.size(), b.size()) << what;
    for (size_t i = 0; i < a.size(); ++i) EXPECT_TRUE(same(a[i], b[i])) << what << ", restart " << i;
  }
  void TearDown() override { EXPECT_NO_THROW(laboratory_.requireNoValidationMessages()); }

  const std::vector<std::string> unbiased_ = {"temporal.mis=pairwise", "temporal.visibilityRays=true",
                                              "spatial.mis=pairwise", "spatial.visibilityRays=true",
                                              "spatial.iterations=2"};
  render::Laboratory laboratory_{{}};
};

TEST_F(Lanes, OfReuseOverSeveralFramesAreRestartsOneByOne) {
  open({.scene = "scenes/cornell.glb"});
  const Pictures one = run("restir_di.json", unbiased_, {.frames = 4}, 1, {7});
  EXPECT_FALSE(same(one[0], one[1])) << "each has a seed of its own";
  expectSame(one, run("restir_di.json", unbiased_, {.frames = 4}, 3, {7}), "7 in 3 lanes");
  expectSame(one, run("restir_di.json", unbiased_, {.frames = 4}, 3, {2, 4, 1}), "in portions");
  expectSame(one, run("restir_di.json", unbiased_, {.frames = 4}, 16, {7}), "in more lanes than there are restarts");
}

TEST_F(Lanes, OfOneFrameWithoutHistoryAreRestartsOneByOne) {
  open({.scene = "scenes/cornell.glb"});
  expectSame(run("all_lights.json", {}, {.firstFrame = 3}, 1, {5}),
             run("all_lights.json", {}, {.firstFrame = 3}, 2, {5}), "5 in 2 lanes");
}

TEST_F(Lanes, OfAMovingSceneAreRestartsOneByOne) {
  open({.scene = "scenes/cornell-moving.glb", .animate = true, .time = 0.1, .timeStep = 0.1});
  const render::RestartOptions options{.frames = 4, .firstFrame = 2, .lastOnly = true};
  const Pictures one = run("restir_di.json", unbiased_, options, 1, {5});
  expectSame(one, run("restir_di.json", unbiased_, options, 3, {5}), "5 in 3 lanes");
  // An odd number of frames, so that restarts begin with either half of what moves.
  const render::RestartOptions odd{.frames = 3, .firstFrame = 2};
  expectSame(run("restir_di.json", unbiased_, odd, 1, {3}), run("restir_di.json", unbiased_, odd, 2, {3}), "odd");
}

TEST_F(Lanes, OfRasterKernelsAreRestartsOneByOne) {
  open({.scene = "scenes/cornell.glb"});
  const TemporaryFolder folder;
  const std::string file = folder.write("raster.json", R"({"version": 1, "passes": {
      "g": {"type": "gbuffer.Raster"}}, "outputs": {"radiance": "g.emission"}})");
  std::vector<Pictures> all;
  for (const uint32_t lanes : {1u, 3u}) {
    render::Restarts restarts(laboratory_, laboratory_.compile(file, {}, 32, 32), {.lanes = lanes});
    restarts.run(4, [&to = all.emplace_back()](std::span<const image::Picture> some) {
      to.insert(to.end(), some.begin(), some.end());
    });
  }
  expectSame(all[0], all[1], "4 in 3 lanes");
}

TEST_F(Lanes, TooManyAreRefused) {
  open({.scene = "scenes/cornell.glb"});
  EXPECT_THROW(render::Restarts(laboratory_, compile("all_lights.json", {}), {.lanes = 65}), InputError);
}

TEST(LanesWords, AreAutoOrANumberInRange) {
  EXPECT_EQ(render::parseLanes("auto"), 0u);
  EXPECT_EQ(render::parseLanes("1"), 1u);
  EXPECT_EQ(render::parseLanes("64"), 64u);
  for (const char* words : {"0", "-1", "65", "1000000", "4294967297", "many", "", " 3", "3 ", "+3", "0x2", "1.5"}) {
    try {
      render::parseLanes(words);
      ADD_FAILURE() << words << " was taken";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(std::string("--lanes ") + words + ": must be auto or 1 … 64"),
                std::string::npos)
          << error.what();
    }
  }
}

TEST(LanesThatFill, AreOneOnACpuAndFewerTheLargerThePicture) {
  const auto device = validatedDevice();
  graph::CompiledGraph graph;
  uint32_t before = device->info().kind == "cpu" ? 1 : 16;
  for (const uint32_t side : {1u, 256u, 512u, 1024u, 16384u}) {
    graph.width = graph.height = side;
    const uint32_t lanes = render::lanesThatFill(*device, graph);
    EXPECT_GE(lanes, 1u);
    EXPECT_LE(lanes, before);
    before = lanes;
  }
  EXPECT_EQ(before, 1u);
  // However small the picture, memory is not taken that isn't there.
  graph.width = graph.height = 16;
  graph.blocks.push_back({.bytes = uint64_t{1} << 50});
  EXPECT_EQ(render::lanesThatFill(*device, graph), 1u);
}

}  // namespace
}  // namespace weir::test
