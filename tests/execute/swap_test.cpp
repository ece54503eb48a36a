// One graph takes another's place between two frames: what of it goes on, what starts anew, and what is left when the
// new one cannot be had.
#include <weir/gpu/vulkan.h>

#include <fstream>
#include <utility>

#include "execute/swap_passes.h"

namespace weir::test {
namespace {

const std::vector<WeirPassEntry> kPasses = {passEntry<Counter>("Counter"), passEntry<Other>("Other")};

/// One counter, reading what it wrote last frame.
std::string counter(const std::string& params) {
  return R"({"b": {"type": "own.Counter", "inputs": {"before": "b.after@previous"}, "params": {)" + params + "}}}";
}

class Swap : public ::testing::Test {
 protected:
  void SetUp() override {
    shader("out_after[i].value = before + uint(param_step + param_fixedStep + LOOKED_AT);");
    options_.shaders = folder_.path();
    run_ = std::make_unique<GraphRun>(counter("\"step\": 100"), "b.after", kPasses, options_);
  }
  void shader(const std::string& last) {
    folder_.write("swap.glsl", R"(
void run(uvec2 pixel) {
  const uint i = (pixel.y * frameWidth + pixel.x) * out_after_count;
  const uint before = in_before[(pixel.y * frameWidth + pixel.x) * in_before_count].value;
  )" + last + "\n}\n");
  }
  void swap(const std::string& passes) { run_->executor().swap(run_->compile(passes, "b.after", options_)); }
  uint32_t value(const std::string& resource) { return run_->read(resource)[0]; }

  TemporaryFolder folder_;
  GraphRun::Options options_;
  std::unique_ptr<GraphRun> run_;
};

TEST_F(Swap, AParameterIsPushedAndHistoryGoesOn) {
  run_->run(3);
  EXPECT_EQ(value("b.after"), 1300u);
  const uint64_t made = run_->executor().pipelinesMade();
  swap(counter("\"step\": 7"));
  run_->run(2);
  EXPECT_EQ(value("b.after"), 1314u);
  EXPECT_EQ(run_->executor().pipelinesMade(), made) << "a pushed parameter needs no pipeline";
}

TEST_F(Swap, ASpecialisedParameterMakesThatPipelineAloneAndHistoryGoesOn) {
  run_->run(3);
  const uint64_t made = run_->executor().pipelinesMade();
  swap(counter("\"step\": 100, \"fixedStep\": 11"));
  run_->run();
  EXPECT_EQ(value("b.after"), 1411u);
  EXPECT_EQ(run_->executor().pipelinesMade(), made + 1);
}

TEST_F(Swap, AParameterThatPrepareLookedAtPreparesAnew) {
  run_->run(1);
  swap(counter("\"step\": 0, \"lookedAt\": 5"));
  run_->run();
  EXPECT_EQ(value("b.after"), 1105u);
}

/// `a` and `b` in one chain, both seen.
std::string chain(const std::string& aType = "own.Counter", const std::string& count = "1", bool enabled = true) {
  return R"({"a": {"type": ")" + aType + R"(", "inputs": {"before": "a.after@previous"}},
    "b": {"type": "own.Counter", "inputs": {"before": "c.after@previous"}, "params": {"step": 10, "count": )" +
         count + R"(}},
    "c": {"type": "own.Counter", "enabled": )" +
         (enabled ? "true" : "false") + R"(, "inputs": {"before": "b.after"}, "params": {"step": 0}},
    "join": {"type": "own.Join", "inputs": {"x": "a.after", "y": "b.after"}}})";
}

class SwapChain : public Swap {
 protected:
  void SetUp() override {
    Swap::SetUp();
    folder_.write("join.glsl", R"(
void run(uvec2 pixel) {
  const uint i = pixel.y * frameWidth + pixel.x;
  out_sum[i].value = in_x[i * in_x_count].value * 10000u + in_y[i * in_y_count].value;
}
)");
    std::vector<WeirPassEntry> passes = kPasses;
    passes.push_back(passEntry<Join>("Join"));
    passes.push_back(passEntry<Paint>("Paint"));
    passes.push_back(passEntry<Step>("Step"));
    passes.push_back(passEntry<Scratchy>("Scratchy"));
    passes.push_back(passEntry<Idle>("Idle"));
    folder_.write("scratchy.glsl", R"(
void run(uvec2 p) {
  const uint i = p.y * frameWidth + p.x;
#ifdef SECOND
  out_word[i].value = scratch_half[i].value + 3u;
#else
  out_word[i].value = 5u;
#endif
}
)");
    folder_.write("step.glsl",
                  "void run(uvec2 p) {\n"
                  "  imageStore(out_image, ivec2(p), vec4(camera.origin.x - previousCamera.origin.x));\n}\n");
    folder_.write("paint.glsl", "void run(uvec2 p) { imageStore(out_image, ivec2(p), vec4(3.0)); }\n");
    run_ = std::make_unique<GraphRun>(chain(), "join.sum", passes, options_);
    run_->run(4);
    expect(1004, 1040, "before any swap");
  }
  void swap(const std::string& passes) { run_->executor().swap(run_->compile(passes, "join.sum", options_)); }
  void expect(uint32_t a, uint32_t b, const std::string& when) {
    EXPECT_EQ(value("a.after"), a) << when;
    EXPECT_EQ(value("b.after"), b) << when;
    EXPECT_EQ(value("join.sum"), a * 10000 + b) << when;
  }
};

TEST_F(SwapChain, AToggleThatChangesTheProducerClearsWhatItProducedAndNothingElse) {
  swap(chain("own.Counter", "1", false));  // c.after@previous is now b.after@previous: another producer
  run_->run();
  expect(1005, 1010, "after disabling");
  run_->run(2);
  swap(chain());
  run_->run();
  expect(1008, 1010, "after enabling again");
}

TEST_F(SwapChain, AToggleClearsAlsoWhereTheNewProducerHadAPastAlready) {
  // b's past is read by d before the toggle, and from then on by b too.
  const auto graph = [](bool enabled) {
    std::string text = chain("own.Counter", "1", enabled);
    text.replace(text.rfind('}'), 1, R"(, "d": {"type": "own.Counter", "inputs": {"before": "b.after@previous"}}})");
    const std::string y = R"("y": "b.after")";
    return text.replace(text.find(y), y.size(), R"("y": "d.after")");
  };
  swap(graph(true));
  run_->run(3);
  const uint32_t before = value("b.after");
  EXPECT_EQ(before, 1070u);
  swap(graph(false));
  run_->run();
  EXPECT_EQ(value("b.after"), 1010u);
}

TEST_F(SwapChain, AnotherTypeOfProducerStartsAnew) {
  swap(chain("own.Other"));
  run_->run();
  expect(1001, 1050, "a by another pass");
}

TEST_F(SwapChain, AnotherLayoutStartsAnew) {
  swap(chain("own.Counter", "3"));
  run_->run();
  expect(1005, 1050, "c counts one element a pixel as before");
  swap(R"({"a": {"type": "own.Counter", "inputs": {"before": "a.after@previous"}, "params": {"count": 2}},
    "join": {"type": "own.Join", "inputs": {"x": "a.after", "y": "a.after"}}})");
  run_->run();
  EXPECT_EQ(value("a.after"), 1001u) << "two elements a pixel now";
}

TEST_F(SwapChain, AnotherSizeStartsAnew) {
  options_.width = 20;
  swap(chain());
  run_->run();
  expect(1001, 1010, "after a resize");
  EXPECT_EQ(run_->read("join.sum").size(), 320u);
}

TEST_F(SwapChain, TheCameraHasNoPastAfterAResizeAndOneAfterAnotherSwap) {
  const std::string graph = R"({"s": {"type": "own.Step"}})",
                    more = R"({"s": {"type": "own.Step"}, "t": {"type": "own.Paint"}})";
  const auto moved = [&](float x) {
    run_->next.camera.eye.x = x;
    run_->run();
    return run_->executor().read("o").rgba[0];
  };
  run_->executor().swap(run_->compile(graph, "s.image", options_));
  moved(1);
  EXPECT_EQ(moved(3), 2.0f);
  run_->executor().restart(run_->compile(more, "s.image", options_));
  EXPECT_EQ(moved(7), 4.0f) << "another graph looks through the same camera";
  options_.width = 24;
  run_->executor().swap(run_->compile(graph, "s.image", options_));
  EXPECT_EQ(moved(12), 0.0f) << "pixels of another size have no past";
  EXPECT_EQ(moved(13), 1.0f);
}

TEST_F(SwapChain, TwoSwapsWithoutAFrameBetweenThemLeaveNoRubbish) {
  swap(chain("own.Other"));
  swap(chain("own.Other", "2"));
  run_->run();
  expect(1001, 1050, "a's history was never cleared between the two");
}

TEST_F(SwapChain, AGraphThatCannotBeHadLeavesTheOldOneRunning) {
  shader("this is no GLSL");
  EXPECT_THROW(swap(chain("own.Other", "2")), RuntimeError);
  run_->run();
  expect(1005, 1050, "after a swap that failed");
}

TEST_F(SwapChain, AnEditedShaderIsTakenAndABrokenOneIsNot) {
  const uint64_t made = run_->executor().pipelinesMade();
  run_->executor().reloadShaders();
  EXPECT_EQ(run_->executor().pipelinesMade(), made) << "nothing was edited";
  run_->run();
  expect(1005, 1050, "after a reload of the same");

  shader("out_after[i].value = before + 2u * uint(param_step);");
  run_->executor().reloadShaders();
  EXPECT_EQ(run_->executor().pipelinesMade(), made + 1) << "one file, one pipeline: three passes share it";
  run_->run();
  expect(1007, 1070, "after an edit");

  shader("out_after[i].value = befor;");
  try {
    run_->executor().reloadShaders();
    ADD_FAILURE() << "a broken shader was taken";
  } catch (const RuntimeError& error) {
    EXPECT_NE(std::string(error.what()).find("swap.glsl:5"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("befor"), std::string::npos) << error.what();
  }
  run_->run();
  expect(1009, 1090, "the old pipeline goes on");
  shader("out_after[i].value = before + uint(param_step);");
  run_->executor().reloadShaders();
  run_->run();
  expect(1010, 1100, "mended");
}

TEST_F(SwapChain, AFrameThatCouldNotBeRecordedNeverWas) {
  swap(chain("own.Other"));  // a's history is new
  Join::fails = true;
  EXPECT_THROW(run_->run(), RuntimeError);
  Join::fails = false;
  run_->run();
  expect(1001, 1050, "the frame after it");
}

TEST_F(SwapChain, AGraphThatWasTakenFromAnExecutorCanBeGivenBack) {
  run_->executor().swap(run_->executor().graph());
  run_->run();
  expect(1005, 1050, "the same graph");
  graph::CompiledGraph changed = run_->executor().graph();
  for (graph::CompiledPass& pass : changed.passes)
    if (pass.name == "b") pass.params["fixedStep"] = int32_t{5};
  run_->executor().swap(std::move(changed));
  run_->run();
  expect(1006, 1065, "another parameter");
}

TEST_F(SwapChain, ScratchOfAGraphThatIsGivenBackIsNotAddedTwice) {
  const std::string graph = R"({"s": {"type": "own.Scratchy"}})";
  run_->executor().swap(run_->compile(graph, "s.word", options_));
  const size_t resources = run_->executor().graph().resources.size();
  EXPECT_EQ(resources, 2u);
  run_->executor().restart(run_->executor().graph());
  EXPECT_EQ(run_->executor().graph().resources.size(), resources);
  run_->run();
  EXPECT_EQ(value("s.word"), 8u);
}

TEST_F(SwapChain, APassThatLaunchesNothingTakesItsTurn) {
  run_->executor().swap(run_->compile(R"({"i": {"type": "own.Idle"}})", "i.word", options_));
  EXPECT_NE(run_->executor().graph().passes[0].stages, 0) << "so that others wait for it, and it for others";
  run_->run(2);
}

PFN_vkCmdPipelineBarrier2 realBarrier = nullptr;
int fullBarriers = 0;
void VKAPI_CALL countingBarrier(VkCommandBuffer commands, const VkDependencyInfo* info) {
  for (uint32_t i = 0; i < info->memoryBarrierCount; ++i)
    fullBarriers += info->pMemoryBarriers[i].srcStageMask == VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT ? 1 : 0;
  realBarrier(commands, info);
}

/// Its plan counts on barriers of the frame before, which were another graph's.
TEST_F(SwapChain, TheFirstFrameWaitsForAllThatTheGraphBeforeDid) {
  const auto barriersOfAFrame = [&] {
    fullBarriers = 0;
    realBarrier = std::exchange(vkCmdPipelineBarrier2, countingBarrier);
    run_->run();
    vkCmdPipelineBarrier2 = realBarrier;
    return fullBarriers;
  };
  EXPECT_EQ(barriersOfAFrame(), 0);
  run_->executor().restart(run_->compile(chain(), "join.sum", options_));
  EXPECT_EQ(barriersOfAFrame(), 1);
  EXPECT_EQ(barriersOfAFrame(), 0);
}

TEST_F(SwapChain, NothingCanBeReadBeforeTheNewGraphHasRun) {
  run_->executor().swap(run_->compile(R"({"g": {"type": "own.Paint"}, "h": {"type": "own.Paint"}})", "g.image", [&] {
    GraphRun::Options o = options_;
    o.keepAll = false;
    return o;
  }()));
  EXPECT_THROW(run_->executor().read("o"), InputError);
  run_->run();
  EXPECT_EQ(run_->executor().read("o").rgba[0], 3.0f);
}

TEST_F(SwapChain, ManySwapsWithFramesInFlight) {
  for (int i = 0; i < 12; ++i) {
    swap(chain("own.Counter", i % 2 == 0 ? "3" : "1"));
    run_->run(1 + i % 3);
  }
  expect(1004 + 24, 1040 + 240, "every frame counted once");
}

}  // namespace
}  // namespace weir::test
