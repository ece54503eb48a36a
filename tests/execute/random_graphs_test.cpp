// Random graphs on the device, their transient memory shared: every pass checks every element that it reads.
#include <weir/gpu/vulkan.h>

#include "execute/pattern_passes.h"

namespace weir::test {
namespace {

constexpr uint32_t kFrames = 4;

/// Elements that all passes look at in one frame, by the plan.
uint64_t checksOf(const graph::CompiledGraph& graph) {
  uint64_t sum = 0;
  for (const graph::CompiledPass& pass : graph.passes) {
    const uint64_t pixels = uint64_t{graph.width} * graph.height;
    for (const graph::Binding& input : pass.inputs) {
      if (input.port == "before") continue;
      const graph::Resource& r = graph.resources[input.resource];
      sum += uint64_t{r.width} * r.height * r.perPixel;
    }
    for (const uint32_t scratch : pass.scratch) {
      const graph::Resource& r = graph.resources[scratch];
      if (!r.depth) sum += uint64_t{r.width} * r.height;
    }
    if ((pass.description->has(Need::SceneAcceleration))) sum += 2 * pixels;
  }
  return sum;
}

/// A graph output that carries a pattern holds what its producer must have written in the last frame.
uint64_t wrongInOutputs(PatternMachine& machine) {
  uint64_t wrong = 0;
  const graph::CompiledGraph& graph = machine.graph();
  for (const graph::GraphOutput& output : graph.outputs) {
    const graph::Resource& r = graph.resources[output.resource];
    const graph::CompiledPass& pass = graph.passes[r.producer];
    for (const graph::Binding& b : pass.outputs) {
      if (b.resource != output.resource || b.port == "faults") continue;
      const uint32_t key =
          patternKey(std::get<int32_t>(pass.params.at("salt")), static_cast<uint32_t>(patternKind(b.port)));
      const std::vector<uint32_t> words = machine.read<uint32_t>(r.name);
      for (uint32_t i = 0; i < words.size(); ++i) {
        const uint32_t value = patternValue(key, machine.frame(), i);
        wrong += words[i] != (b.port == "f" ? std::bit_cast<uint32_t>(static_cast<float>(value & 0xffffffu)) : value);
      }
      wrong += words.size() != uint64_t{r.width} * r.height * r.perPixel;
    }
  }
  return wrong;
}

constexpr int kGraphs = 500;  ///< with poison, and as many without

class RandomGraphsRun : public ::testing::TestWithParam<bool> {};

TEST_P(RandomGraphsRun, EveryElementIsWhatItsProducerWrote) {
  std::mt19937 random(GetParam() ? 1 : 2);
  PatternMachine machine(GetParam());
  uint64_t checked = 0, shared = 0, starts = 0, history = 0, skipped = 0, refused = 0;
  for (int done = 0; done < kGraphs;) {
    const std::string json = randomPatternGraph(random, machine.types);
    const auto side = [&](uint32_t from, uint32_t choices) { return from + static_cast<uint32_t>(random() % choices); };
    auto graph = machine.compile(json, side(3, 15), side(2, 11));
    if (!graph) {
      ASSERT_LT(++refused, 2000u) << machine.lastFinding;
      continue;
    }
    ++done;
    machine.load(std::move(*graph));
    machine.run(kFrames);
    const Faults faults = machine.faults();
    ASSERT_EQ(faults.wrong, 0u) << "of " << faults.checked << ", graph " << done << "\n"
                                << json << "\n"
                                << explain(machine.graph());
    ASSERT_EQ(faults.checked, kFrames * checksOf(machine.graph())) << json;
    ASSERT_EQ(wrongInOutputs(machine), 0u) << json << "\n" << explain(machine.graph());
    checked += faults.checked;
    skipped += machine.graph().skipped.empty() ? 0 : 1;
    for (const graph::CompiledPass& pass : machine.graph().passes) starts += pass.starts.size();
    for (const graph::Resource& r : machine.graph().resources) {
      shared += r.shares ? 1 : 0;
      history += r.history ? 1 : 0;
    }
  }
  std::cout << fmt::format(
      "{} elements checked in {} graphs, {} resources shared memory, {} images started, {} had "
      "history, {} graphs with skipped passes, {} graphs refused, {} pipelines\n",
      checked, kGraphs, shared, starts, history, skipped, refused, machine.executor().pipelinesMade());
  EXPECT_GT(checked, 1'000'000u);
  EXPECT_GT(shared, 2500u);
  EXPECT_GT(starts, 2500u);
  EXPECT_GT(history, 2500u);
  EXPECT_GT(skipped, 100u);
}

using Damage = std::function<void(graph::CompiledGraph&, uint32_t resource)>;

/// How many of so many random graphs are found wrong when one resource of each that is read after it was written has
/// another lifetime than it has.
int foundOf(int graphs, bool poison, const Damage& damage) {
  std::mt19937 random(3);
  PatternMachine machine(poison);
  int found = 0;
  for (int done = 0; done < graphs;) {
    auto graph = machine.compile(randomPatternGraph(random, machine.types), 13, 9);
    if (!graph) continue;
    std::vector<uint32_t> candidates;
    for (uint32_t r = 0; r < graph->resources.size(); ++r)
      if (graph->resources[r].transient() && !graph->resources[r].graphOutput &&
          graph->resources[r].lastUse > graph->resources[r].firstUse)
        candidates.push_back(r);
    if (candidates.empty()) continue;
    ++done;
    damage(*graph, candidates[random() % candidates.size()]);
    machine.load(std::move(*graph));
    machine.run(2);
    found += machine.faults().wrong > 0 ? 1 : 0;
  }
  return found;
}

TEST(RandomGraphs, WouldNoticeALifeThatEndsTooEarly) {
  const Damage damage = [](graph::CompiledGraph& graph, uint32_t r) {
    graph.resources[r].lastUse = graph.resources[r].firstUse;
  };
  EXPECT_EQ(foundOf(40, true, damage), 40);
  // Without poison only where somebody else really took the memory.
  EXPECT_GT(foundOf(40, false, damage), 4);
}

TEST(RandomGraphs, WouldNoticeALifeThatBeginsTooLate) {
  const Damage damage = [](graph::CompiledGraph& graph, uint32_t r) {
    graph.resources[r].firstUse = graph.resources[r].lastUse;
  };
  EXPECT_EQ(foundOf(40, true, damage), 40);
}

PFN_vkCmdPipelineBarrier2 realBarrier = nullptr;

/// Images still get their layouts; nothing waits for memory.
void VKAPI_CALL withoutMemoryBarriers(VkCommandBuffer commands, const VkDependencyInfo* info) {
  VkDependencyInfo less = *info;
  less.memoryBarrierCount = 0;
  std::vector<VkImageMemoryBarrier2> images(info->pImageMemoryBarriers,
                                            info->pImageMemoryBarriers + info->imageMemoryBarrierCount);
  for (VkImageMemoryBarrier2& image : images) image.srcStageMask = image.srcAccessMask = 0;
  less.pImageMemoryBarriers = images.data();
  if (!images.empty()) realBarrier(commands, &less);
}

PFN_vkCmdWriteTimestamp2 realTimestamp = nullptr;

/// Waits for nothing: on some devices a timestamp that waits for all work keeps work apart as a barrier does.
void VKAPI_CALL earlyTimestamp(VkCommandBuffer commands, VkPipelineStageFlags2, VkQueryPool pool, uint32_t query) {
  realTimestamp(commands, VK_PIPELINE_STAGE_2_TOP_OF_PIPE_BIT, pool, query);
}

/// That the graphs above could find missing barriers at all, shown where work really overlaps.
TEST(RandomGraphs, WouldNoticeMissingBarriersOnAGpu) {
  const std::string kind = validatedDevice()->info().kind;
  if (kind == "cpu") GTEST_SKIP() << "this device runs one pass after the other whatever barriers say";
  if (validationWanted()) GTEST_SKIP() << "the layers would find it first: WEIR_TEST_VALIDATION=off";
  constexpr int kLarge = 30;
  for (const bool damaged : {false, true}) {
    std::mt19937 random(4);
    PatternMachine machine(false);
    int found = 0;
    for (int done = 0; done < kLarge;) {
      auto graph = machine.compile(randomPatternGraph(random, machine.types), 1000, 701);
      if (!graph) continue;
      ++done;
      machine.load(std::move(*graph));
      realTimestamp = std::exchange(vkCmdWriteTimestamp2, earlyTimestamp);
      if (damaged) realBarrier = std::exchange(vkCmdPipelineBarrier2, withoutMemoryBarriers);
      machine.run(kFrames);
      if (damaged) vkCmdPipelineBarrier2 = realBarrier;
      vkCmdWriteTimestamp2 = realTimestamp;
      found += machine.faults().wrong > 0 ? 1 : 0;
    }
    std::cout << found << " of " << kLarge << " graphs wrong " << (damaged ? "without" : "with") << " barriers\n";
    if (damaged)
      EXPECT_GT(found, 0);
    else
      EXPECT_EQ(found, 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Poisoned, RandomGraphsRun, ::testing::Values(true));
INSTANTIATE_TEST_SUITE_P(Unpoisoned, RandomGraphsRun, ::testing::Values(false));

}  // namespace
}  // namespace weir::test
