// The loop of frames once it runs: nothing is allocated, nothing waits for the device to be idle, and one submission a
// frame goes out.
#include <weir/gpu/vulkan.h>
#include <weir/render/stage.h>

#include <atomic>
#include <cstdlib>
#include <new>
#include <utility>

#include "execute/graph_run.h"

namespace {

thread_local bool counting = false;
std::atomic<uint64_t> allocations{0};

#ifndef __SANITIZE_ADDRESS__
void* counted(size_t size) {
  if (counting) ++allocations;
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}
#endif

}  // namespace

// The whole program's, the libraries' it loads included. A sanitizer has its own.
#ifndef __SANITIZE_ADDRESS__
void* operator new(size_t size) {
  return counted(size);
}
void* operator new[](size_t size) {
  return counted(size);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, size_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, size_t) noexcept {
  std::free(memory);
}
#endif

namespace weir::test {
namespace {

/// Allocations of this thread while `work` runs.
template <typename Work>
uint64_t allocationsOf(Work work) {
  allocations = 0;
  counting = true;
  work();
  counting = false;
  return allocations;
}

/// A graph of the house over a scene, without the validation layers, which allocate as they please.
class Steady : public ::testing::Test {
 protected:
  void SetUp() override {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "a sanitizer's own allocator can't be counted";
#endif
  }
  static gpu::DeviceOptions options() {
    gpu::DeviceOptions o;
    o.choice = deviceChoice();
    return o;
  }
  void start(const std::string& graph, const graph::Overrides& overrides = {},
             const std::string& scene = "scenes/cornell.glb", uint32_t lanes = 1) {
    const std::string path = graph.starts_with("/") ? graph : sourcePath("graphs/" + graph);
    executor_.reset();
    scene_.reset();
    render::StageOptions stageOptions;
    stageOptions.scene = sourcePath(scene);
    stageOptions.animate = scene.find("moving") != std::string::npos;
    stage_ = std::make_unique<render::Stage>(render::makeStage(stageOptions, 1.0f));
    player_ = std::make_unique<render::Player>(*stage_);
    scene_ = std::make_unique<scene::SceneGpu>(device_, stage_->scene, stage_->prepared,
                                               device_.capabilities().accelerationStructure);
    execute::ExecutorOptions o;
    o.backend = trace::chooseBackend("auto", device_);
    o.lanes = lanes;
    seeds_.assign(lanes, 1);
    executor_ = std::make_unique<execute::Executor>(
        device_, compiler_, registry_, *scene_, graph::compileFile(path, overrides, registry_.catalog(), 32, 32), o);
  }
  /// Only the frames themselves are counted: where a clip takes the scene is worked out before.
  uint64_t allocationsIn(uint32_t frames) {
    uint64_t sum = 0;
    for (uint32_t i = 0; i < frames; ++i) {
      execute::FrameInput input = player_->frame(number_++, 1);
      input.laneSeeds = seeds_;
      sum += allocationsOf([&] { executor_->frame(input); });
    }
    return sum;
  }

  gpu::Device device_{options()};
  Registry registry_{{std::filesystem::path(binaryPath("bin"))}};
  shader::Compiler compiler_;
  std::unique_ptr<render::Stage> stage_;
  std::unique_ptr<render::Player> player_;
  std::unique_ptr<scene::SceneGpu> scene_;
  std::unique_ptr<execute::Executor> executor_;
  uint32_t number_ = 0;
  std::vector<uint32_t> seeds_;
};

TEST_F(Steady, TheCounterCounts) {
  EXPECT_GE(allocationsOf([] { std::vector<int>(1000).swap(*std::make_unique<std::vector<int>>()); }), 2u);
  EXPECT_EQ(allocationsOf([] {}), 0u);
}

TEST_F(Steady, AFrameAllocatesNothing) {
  start("restir_di.json");
  allocationsIn(4);
  EXPECT_EQ(allocationsIn(20), 0u);
  start("restir_di.json", {{"spatial.iterations=3", "spatial.visibilityRays=true"}, {}, {"temporal"}});
  allocationsIn(4);
  EXPECT_EQ(allocationsIn(20), 0u) << "with scratch buffers and launches that bind them";
}

TEST_F(Steady, AFrameOfAMovingSceneAllocatesNothing) {
  start("restir_di.json", {}, "scenes/cornell-moving.glb");
  allocationsIn(4);
  EXPECT_EQ(allocationsIn(10), 0u);
}

TEST_F(Steady, AFrameOfSeveralLanesAllocatesNothing) {
  start("restir_di.json", {}, "scenes/cornell-moving.glb", 3);
  allocationsIn(4);
  EXPECT_EQ(allocationsIn(10), 0u);
}

TEST_F(Steady, AFrameWithRasterKernelsAllocatesNothing) {
  const TemporaryFolder folder;
  start(folder.write("raster.json", R"({"version": 1, "passes": {"g": {"type": "gbuffer.Raster"}},
                                        "outputs": {"o": "g.emission"}})"));
  allocationsIn(4);
  EXPECT_EQ(allocationsIn(20), 0u);
}

/// Counts calls of two of Vulkan's functions.
std::atomic<int> submissions{0}, waits{0};
PFN_vkQueueSubmit2 realSubmit = nullptr;
PFN_vkDeviceWaitIdle realIdle = nullptr;
VkResult VKAPI_CALL countingSubmit(VkQueue queue, uint32_t count, const VkSubmitInfo2* infos, VkFence fence) {
  ++submissions;
  return realSubmit(queue, count, infos, fence);
}
VkResult VKAPI_CALL countingIdle(VkDevice device) {
  ++waits;
  return realIdle(device);
}

TEST_F(Steady, OneSubmissionAFrameAndNoWaitForAnIdleDevice) {
  start("restir_di.json", {}, "scenes/cornell.glb", 2);
  allocationsIn(3);
  realSubmit = std::exchange(vkQueueSubmit2, countingSubmit);
  realIdle = std::exchange(vkDeviceWaitIdle, countingIdle);
  submissions = waits = 0;
  allocationsIn(10);
  vkQueueSubmit2 = realSubmit;
  vkDeviceWaitIdle = realIdle;
  EXPECT_EQ(submissions, 10);
  EXPECT_EQ(waits, 0);
}

TEST_F(Steady, TimesOfFramesAreKeptAndTaken) {
  start("restir_di.json");
  allocationsIn(5);
  executor_->finish();
  std::vector<execute::FrameTimes> times = executor_->takeTimes();
  ASSERT_EQ(times.size(), 5u);
  for (const execute::FrameTimes& t : times) {
    EXPECT_EQ(t.cpu.size(), executor_->graph().passes.size());
    EXPECT_EQ(t.gpu.size(), device_.capabilities().timestampPeriod > 0 ? executor_->graph().passes.size() : 0u);
    double sum = t.gpuScene;
    for (const double gpu : t.gpu) {
      EXPECT_GE(gpu, 0.0);
      sum += gpu;
    }
    if (!t.gpu.empty()) {
      EXPECT_GT(t.gpuFrame, 0.0);
      EXPECT_NEAR(sum, t.gpuFrame, 1e-6 + 1e-6 * t.gpuFrame) << "the parts make up the whole";
    }
  }
  EXPECT_TRUE(executor_->takeTimes().empty());
  allocationsIn(execute::Executor::kTimesKept + 9);
  executor_->finish();
  EXPECT_EQ(executor_->takeTimes().size(), execute::Executor::kTimesKept) << "the oldest make room";
}

}  // namespace
}  // namespace weir::test
