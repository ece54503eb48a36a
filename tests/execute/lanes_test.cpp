// Several lanes of a graph: each is what a run of its own would be, whatever its neighbours do; and nothing stands
// between the lanes of a launch.
#include <weir/core/error.h>
#include <weir/gpu/vulkan.h>

#include <array>
#include <utility>

#include "execute/graph_run.h"

namespace weir::test {
namespace {

using Words = std::vector<uint32_t>;

/// A random walk of each pixel: from where it was in the last frame, by the frame's number and seed.
class Walk final : public Pass {
 public:
  static void describe(PassDescription& d) {
    d.input("before", perPixel<Word>());
    d.output("after", perPixel<Word>());
    d.param("add", 0);
    d.needs(Need::FrameIndex);
  }
  // Two launches, the second of which needs what the first one wrote elsewhere.
  void prepare(PrepareContext& c) override {
    c.scratch("half", perPixel<Word>());
    kernel_ = c.kernel("walk.glsl");
  }
  void record(RecordContext& c) override {
    c.launch(kernel_, 0);
    c.launch(kernel_, 1);
  }

 private:
  Kernel kernel_;
};

/// An image and a buffer that live within a frame, so that they share memory with others.
class Mirror final : public Pass {
 public:
  static void describe(PassDescription& d) {
    d.input("in", perPixel<Word>());
    d.output("image", storageImage(Format::R32U));
    d.output("out", perPixel<Word>());
  }
  void prepare(PrepareContext& c) override { kernel_ = c.kernel("mirror.glsl"); }
  void record(RecordContext& c) override { c.launch(kernel_); }

 private:
  Kernel kernel_;
};

class Picture final : public Pass {
 public:
  static void describe(PassDescription& d) {
    d.input("image", storageImage(Format::R32U));
    d.input("words", perPixel<Word>());
    d.output("image", storageImage(Format::RG32F));
  }
  void prepare(PrepareContext& c) override { kernel_ = c.kernel("picture.glsl"); }
  void record(RecordContext& c) override { c.launch(kernel_); }

 private:
  Kernel kernel_;
};

class Lanes : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.write("walk.glsl", R"(
void run(uvec2 p) {
  uint i = p.y * frameWidth + p.x, j = frameWidth * frameHeight - 1u - i;
  if (launchIndex == 0u)
    scratch_half[i].value = in_before[i].value * 747796405u + frameSeed + 31u * frameIndex + i + uint(param_add);
  else
    out_after[i].value = scratch_half[i].value ^ (scratch_half[j].value >> 7);
})");
    folder_.write("mirror.glsl", R"(
void run(uvec2 p) {
  uint i = p.y * frameWidth + p.x, j = frameWidth * frameHeight - 1u - i;
  imageStore(out_image, ivec2(p), uvec4(in_in[j].value));
  out_out[i].value = in_in[j].value + 1u;
})");
    folder_.write("picture.glsl", R"(
void run(uvec2 p) {
  uint i = p.y * frameWidth + p.x;
  imageStore(out_image, ivec2(p), vec4(float(imageLoad(in_image, ivec2(p)).x >> 8), float(in_words[i].value & 0xffffu), 0, 0));
})");
  }
  /// With memory that is shared and, where dead, overwritten: what a lane takes from another shows.
  std::unique_ptr<GraphRun> make(uint32_t lanes) {
    return std::make_unique<GraphRun>(kGraph, "p.image", entries(), options(lanes));
  }
  GraphRun::Options options(uint32_t lanes) const {
    GraphRun::Options o;
    o.shaders = folder_.path();
    o.keepAll = false;
    o.poison = true;
    o.lanes = lanes;
    return o;
  }
  static std::vector<WeirPassEntry> entries() {
    return {passEntry<Walk>("Walk"), passEntry<Mirror>("Mirror"), passEntry<Picture>("Picture")};
  }
  static void frames(GraphRun& run, const Words& seeds, uint32_t count) {
    run.next.laneSeeds = seeds;
    run.run(count);
    run.next.laneSeeds = {};
  }
  /// What a run alone with this seed has after so many frames.
  std::pair<Words, image::Picture> alone(uint32_t seed, uint32_t count) {
    const auto run = make(1);
    run->next.seed = seed;
    run->run(count);
    return {run->read("w.after"), run->executor().read("o")};
  }
  void expectLanes(GraphRun& run, const Words& seeds, uint32_t count) {
    for (uint32_t lane = 0; lane < seeds.size(); ++lane) {
      const auto [words, picture] = alone(seeds[lane], count);
      EXPECT_EQ(run.read("w.after", lane), words) << "lane " << lane;
      EXPECT_EQ(run.executor().read("o", lane).rgba, picture.rgba) << "lane " << lane;
    }
  }

  static constexpr const char* kGraph = R"({
      "w": {"type": "own.Walk", "inputs": {"before": "w.after@previous"}},
      "m": {"type": "own.Mirror", "inputs": {"in": "w.after"}},
      "n": {"type": "own.Mirror", "inputs": {"in": "m.out"}},
      "p": {"type": "own.Picture", "inputs": {"image": "m.image", "words": "n.out"}}})";
  TemporaryFolder folder_;
};

TEST_F(Lanes, EachIsWhatARunOfItsOwnWouldBe) {
  const auto run = make(3);
  const Words seeds = {7, 8, 9};
  frames(*run, seeds, 5);
  expectLanes(*run, seeds, 5);
  EXPECT_NE(run->read("w.after", 0), run->read("w.after", 1));
  EXPECT_THROW(run->read("w.after", 3), InputError);
}

TEST_F(Lanes, SomeCanBeLeftOutAndComeBackAfterACut) {
  const auto run = make(3);
  frames(*run, {7, 8, 9}, 2);
  run->executor().resetHistory();
  run->next.index = 0;
  frames(*run, {4, 5}, 3);
  expectLanes(*run, {4, 5}, 3);
  EXPECT_THROW(run->read("w.after", 2), InputError) << "the last frame did not have it";
  EXPECT_THROW(frames(*run, {4, 5, 6}, 1), InputError) << "its past is not the last frame's";
  run->executor().resetHistory();
  run->next.index = 0;
  frames(*run, {1, 2, 3}, 2);
  expectLanes(*run, {1, 2, 3}, 2);
}

TEST_F(Lanes, WithoutSeedsTheFirstOneAloneRuns) {
  const auto run = make(2);
  run->next.seed = 6;
  run->run(2);
  EXPECT_EQ(run->read("w.after"), alone(6, 2).first);
  EXPECT_THROW(run->read("w.after", 1), InputError);
}

TEST_F(Lanes, MoreThanThereAreAreRefused) {
  const auto run = make(2);
  EXPECT_THROW(frames(*run, {1, 2, 3}, 1), InputError);
  frames(*run, {1, 2}, 2);
  expectLanes(*run, {1, 2}, 2);
  EXPECT_THROW(make(0), InputError);
  EXPECT_THROW(make(execute::SceneFrame::kMostLanes + 1), InputError);
}

TEST_F(Lanes, KeepTheirHistoryWhenTheGraphIsSwapped) {
  const auto run = make(3);
  const Words seeds = {1, 2, 3};
  frames(*run, seeds, 3);
  run->executor().restart(run->compile(kGraph, "p.image", options(3)));
  frames(*run, seeds, 2);
  expectLanes(*run, seeds, 5);
}

TEST_F(Lanes, CapturesComeLaneByLane) {
  const auto run = make(3);
  std::vector<std::vector<float>> one, all;
  run->executor().captureTo({"o"}, [&](const std::string&, const image::Picture& p) { one.push_back(p.rgba); });
  const Words seeds = {1, 2, 3};
  run->next.laneSeeds = seeds;
  run->executor().frame(run->next, true);
  run->executor().finish();
  ASSERT_EQ(one.size(), 3u);
  for (uint32_t lane = 0; lane < 3; ++lane) EXPECT_EQ(one[lane], alone(seeds[lane], 1).second.rgba) << lane;
  run->executor().captureLanesTo({"o"}, [&](const std::string&, std::span<const image::Picture> lanes) {
    for (const image::Picture& p : lanes) all.push_back(p.rgba);
  });
  run->executor().resetHistory();
  run->next.laneSeeds = std::span(seeds).first(2);
  run->executor().frame(run->next, true);
  run->executor().finish();
  EXPECT_EQ(all, std::vector(one.begin(), one.begin() + 2));
}

TEST_F(Lanes, TakeMemoryEach) {
  const auto one = make(1), three = make(3);
  EXPECT_EQ(three->executor().transientBytes(), 3 * one->executor().transientBytes());
  EXPECT_EQ(three->executor().historyBytes(), 3 * one->executor().historyBytes());
  EXPECT_EQ(three->executor().savedBytes(), 3 * one->executor().savedBytes());
  EXPECT_EQ(three->executor().pipelinesMade(), one->executor().pipelinesMade()) << "pipelines are shared";
}

/// 'b' for a barrier, 'd' for a dispatch, as they are recorded.
std::string recorded;
PFN_vkCmdPipelineBarrier2 realBarrier = nullptr;
PFN_vkCmdDispatch realDispatch = nullptr;
void VKAPI_CALL notingBarrier(VkCommandBuffer commands, const VkDependencyInfo* info) {
  recorded += 'b';
  realBarrier(commands, info);
}
void VKAPI_CALL notingDispatch(VkCommandBuffer commands, uint32_t x, uint32_t y, uint32_t z) {
  recorded += 'd';
  realDispatch(commands, x, y, z);
}

TEST_F(Lanes, NothingStandsBetweenTheLanesOfALaunch) {
  std::vector<std::string> each;
  for (const uint32_t lanes : {1u, 3u}) {
    GraphRun::Options plain = options(lanes);
    plain.poison = false;
    GraphRun run(kGraph, "p.image", entries(), plain);
    const Words seeds(lanes, 1);
    frames(run, seeds, 2);
    recorded.clear();
    realBarrier = std::exchange(vkCmdPipelineBarrier2, notingBarrier);
    realDispatch = std::exchange(vkCmdDispatch, notingDispatch);
    frames(run, seeds, 1);
    vkCmdPipelineBarrier2 = realBarrier;
    vkCmdDispatch = realDispatch;
    each.push_back(recorded);
  }
  EXPECT_EQ(std::count(each[0].begin(), each[0].end(), 'd'), 5) << each[0];
  std::string threefold;
  for (const char c : each[0]) threefold += c == 'd' ? "ddd" : "b";
  EXPECT_EQ(each[1], threefold);
}

}  // namespace
}  // namespace weir::test
