// Pictures of frames that are brought to the host by the frames' own submissions, while later ones run.
#include <weir/gpu/vulkan.h>

#include <atomic>
#include <utility>

#include "execute/graph_run.h"

namespace weir::test {
namespace {

/// The frame's number and the pixel's column.
class Number final : public Pass {
 public:
  static void describe(PassDescription& d) {
    d.output("image", storageImage(Format::RG32F));
    d.param("add", 0);
    d.needs(Need::FrameIndex);
  }
  void prepare(PrepareContext& c) override { kernel_ = c.kernel("number.glsl"); }
  void record(RecordContext& c) override { c.launch(kernel_); }

 private:
  Kernel kernel_;
};

std::atomic<int> submissions{0};
PFN_vkQueueSubmit2 realSubmit = nullptr;
VkResult VKAPI_CALL countingSubmit(VkQueue queue, uint32_t count, const VkSubmitInfo2* infos, VkFence fence) {
  ++submissions;
  return realSubmit(queue, count, infos, fence);
}

class Capture : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.write(
        "number.glsl",
        "void run(uvec2 p) {\n"
        "  imageStore(out_image, ivec2(p), vec4(float(frameIndex) + float(param_add), float(p.x), 0, 0));\n}\n");
    options_.shaders = folder_.path();
    options_.keepAll = false;
    run_ = std::make_unique<GraphRun>(kGraph, "n.image", std::vector<WeirPassEntry>{passEntry<Number>("Number")},
                                      options_);
    run_->executor().captureTo({"o"}, [this](const std::string& output, const image::Picture& picture) {
      EXPECT_EQ(output, "o");
      EXPECT_EQ(picture.width, 16u);
      EXPECT_EQ(picture.rgba[4 * 5 + 1], 5.0f);
      seen_.push_back(picture.rgba[0]);
    });
  }
  void frame(bool capture) {
    run_->executor().frame(run_->next, capture);
    ++run_->next.index;
  }

  static constexpr const char* kGraph = R"({"n": {"type": "own.Number"}})";
  TemporaryFolder folder_;
  GraphRun::Options options_;
  std::unique_ptr<GraphRun> run_;
  std::vector<float> seen_;
};

TEST_F(Capture, EachFrameOnceAndInOrderWithoutASubmissionMore) {
  run_->next.index = 100;
  realSubmit = std::exchange(vkQueueSubmit2, countingSubmit);
  submissions = 0;
  for (int i = 0; i < 7; ++i) frame(i != 3);
  run_->executor().finish();
  vkQueueSubmit2 = realSubmit;
  EXPECT_EQ(submissions, 7);
  EXPECT_EQ(seen_, (std::vector<float>{100, 101, 102, 104, 105, 106})) << "all but the fourth";
}

TEST_F(Capture, NobodyWaitsForThem) {
  frame(true);
  frame(true);
  EXPECT_TRUE(seen_.empty()) << "a picture comes when its slot's turn comes again";
  frame(true);
  EXPECT_EQ(seen_.size(), 1u);
}

TEST_F(Capture, IsWhatReadingGives) {
  frame(true);
  const image::Picture read = run_->executor().read("o");
  ASSERT_EQ(seen_.size(), 1u);
  EXPECT_EQ(read.rgba[0], seen_[0]);
}

TEST_F(Capture, ParametersDoNotEndItAndAnotherGraphDoes) {
  options_.overrides.set = {"n.add=1000"};
  frame(true);
  run_->executor().swap(run_->compile(kGraph, "n.image", options_));
  frame(true);
  run_->executor().finish();
  EXPECT_EQ(seen_, (std::vector<float>{0, 1001}));
  options_.width = 20;
  run_->executor().swap(run_->compile(kGraph, "n.image", options_));
  frame(true);
  run_->executor().finish();
  EXPECT_EQ(seen_.size(), 2u);
}

TEST_F(Capture, UnknownOutputsAreRefusedAndWhatWasThereGoesOn) {
  EXPECT_THROW(run_->executor().captureTo({"o", "oo"}, [](const std::string&, const image::Picture&) {}), InputError);
  EXPECT_THROW(run_->executor().captureTo({"o"}, {}), InputError);
  frame(true);
  run_->executor().finish();
  EXPECT_EQ(seen_.size(), 1u);
}

TEST_F(Capture, WhatReceivesAPictureCannotTurnTheExecutorRound) {
  int refused = 0;
  execute::Executor& executor = run_->executor();
  executor.captureTo({"o"}, [&](const std::string&, const image::Picture&) {
    const std::vector<std::function<void()>> calls = {[&] { executor.captureTo({}, {}); }, [&] { frame(false); },
                                                      [&] { executor.reloadShaders(); }};
    for (const auto& call : calls) {
      try {
        call();
      } catch (const InputError&) {
        ++refused;
      }
    }
  });
  frame(true);
  executor.finish();
  EXPECT_EQ(refused, 3);
  frame(true);
  executor.finish();
  EXPECT_EQ(refused, 6) << "and it goes on";
}

}  // namespace
}  // namespace weir::test
