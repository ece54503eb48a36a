// Random graphs under a model of Vulkan's barriers: nothing goes wrong with all of them, and something does without
// any one of them.
#include "memory_model.h"
#include "random_graphs.h"

#include <gtest/gtest.h>

#include <cstddef>

namespace weir::graph::test {
namespace {

constexpr int kFrames = 6;

std::string faultOf(const CompiledGraph& graph) {
  return MemoryModel(graph).run(kFrames);
}

TEST(Hazards, NoneInRandomGraphs) {
  RandomGraphs random(20240607);
  int withHistory = 0, sharing = 0, starts = 0, scratch = 0, several = 0, skipped = 0, barriers = 0, passes = 0;
  for (int i = 0; i < 3000; ++i) {
    CompiledGraph graph = random.next();
    random.plan(graph);
    ASSERT_EQ(faultOf(graph), "") << "graph " << i << "\n" << random.json << explain(graph);
    several += graph.blocks.size() > 1 ? 1 : 0;
    skipped += graph.skipped.empty() ? 0 : 1;
    for (const CompiledPass& pass : graph.passes) {
      ++passes;
      barriers += pass.waits.empty() && pass.starts.empty() ? 0 : 1;
      starts += static_cast<int>(pass.starts.size());
      scratch += static_cast<int>(pass.scratch.size());
    }
    for (const Resource& r : graph.resources) {
      withHistory += r.history ? 1 : 0;
      sharing += r.shares ? 1 : 0;
    }
  }
  // All of it came up.
  EXPECT_GT(withHistory, 2000);
  EXPECT_GT(sharing, 5000);
  EXPECT_GT(starts, 3000);
  EXPECT_GT(scratch, 3000);
  EXPECT_GT(several, 500);
  EXPECT_GT(skipped, 500);
  EXPECT_LT(barriers, passes) << "some passes need none";
  RecordProperty("passes", passes);
  RecordProperty("passesWithBarriers", barriers);
}

/// Calls `change` for every way to take something from a pass's barriers, one at a time, with its name.
template <typename Check>
void forEachLoss(CompiledGraph& graph, const Check& check) {
  for (CompiledPass& pass : graph.passes) {
    const std::vector<Wait> waits = pass.waits;
    const std::vector<ImageStart> starts = pass.starts;
    const auto tryWaits = [&](const std::string& what, size_t i, auto change) {
      if (change(pass.waits[i])) check(fmt::format("{}: {} of wait {}", pass.name, what, i + 1));
      pass.waits = waits;
    };
    for (size_t i = 0; i < waits.size(); ++i) {
      pass.waits.erase(pass.waits.begin() + static_cast<std::ptrdiff_t>(i));
      check(fmt::format("{}: wait {}", pass.name, i + 1));
      pass.waits = waits;
      tryWaits("writes", i, [](Wait& w) { return std::exchange(w.writes, false); });
      tryWaits("toReads", i, [](Wait& w) { return std::exchange(w.toReads, false); });
      tryWaits("toWrites", i, [](Wait& w) { return std::exchange(w.toWrites, false); });
      for (const Stages bit : {kComputeStage, kRayStage, kRasterStage}) {
        const auto without = [bit](Stages& mask) {
          const bool had = (mask & bit) != 0;
          mask &= static_cast<Stages>(~bit);
          return had;
        };
        tryWaits(fmt::format("from {}", bit), i, [&](Wait& w) { return without(w.from); });
        tryWaits(fmt::format("to {}", bit), i, [&](Wait& w) { return without(w.to); });
      }
    }
    for (size_t i = 0; i < starts.size(); ++i) {
      pass.starts.erase(pass.starts.begin() + static_cast<std::ptrdiff_t>(i));
      check(fmt::format("{}: start {}", pass.name, i + 1));
      pass.starts = starts;
      for (const Stages bit : {kComputeStage, kRayStage, kRasterStage}) {
        if ((starts[i].from & bit) == 0) continue;
        pass.starts[i].from &= static_cast<Stages>(~bit);
        check(fmt::format("{}: from {} of start {}", pass.name, bit, i + 1));
        pass.starts = starts;
      }
    }
  }
}

TEST(Hazards, EveryBarrierAndEveryBitOfOneIsNeeded) {
  RandomGraphs random(77);
  int losses = 0, spare = 0;
  for (int i = 0; i < 2000; ++i) {
    CompiledGraph graph = random.next();
    random.plan(graph);
    const std::string plan = explain(graph);
    forEachLoss(graph, [&](const std::string& what) {
      ++losses;
      if (!faultOf(graph).empty()) return;
      ++spare;
      if (spare < 4)
        ADD_FAILURE() << "graph " << i << ", nobody misses " << what << "\n" << random.json << "\n" << plan;
    });
  }
  EXPECT_EQ(spare, 0) << "of " << losses;
  EXPECT_GT(losses, 40'000);
}

/// Two resources that are alive in the same pass have bytes in common.
bool livesTogetherAndShares(const CompiledGraph& graph, const std::vector<std::pair<uint32_t, uint32_t>>& lives) {
  for (size_t a = 0; a < graph.resources.size(); ++a)
    for (size_t b = 0; b < a; ++b)
      if (shareMemory(graph.resources[a], graph.resources[b]) && lives[a].first <= lives[b].second &&
          lives[b].first <= lives[a].second)
        return true;
  return false;
}

std::vector<std::pair<uint32_t, uint32_t>> livesOf(const CompiledGraph& graph) {
  std::vector<std::pair<uint32_t, uint32_t>> lives;
  for (const Resource& r : graph.resources) lives.emplace_back(r.firstUse, r.lastUse);
  return lives;
}

TEST(Hazards, MemoryThatIsStillInUseIsSeenToBeTaken) {
  RandomGraphs random(5);
  int moved = 0;
  for (int i = 0; i < 1500; ++i) {
    CompiledGraph graph = random.next();
    random.plan(graph);
    const auto lives = livesOf(graph);
    // One resource onto the place of another that lives at the same time.
    const auto count = static_cast<int>(graph.resources.size());
    Resource &a = graph.resources[random.below(count)], &b = graph.resources[random.below(count)];
    if (&a == &b || a.block == kNone || b.block == kNone || a.firstUse > b.lastUse || b.firstUse > a.lastUse) continue;
    ++moved;
    a.block = b.block;
    a.offset = b.offset;
    for (size_t x = 0; x < graph.resources.size(); ++x)
      for (size_t y = 0; y < graph.resources.size(); ++y)
        if (x != y && shareMemory(graph.resources[x], graph.resources[y])) graph.resources[x].shares = true;
    planBarriers(graph);
    ASSERT_TRUE(livesTogetherAndShares(graph, lives));
    ASSERT_NE(faultOf(graph), "") << a.name << " lies on " << b.name << "\n" << random.json << explain(graph);
  }
  EXPECT_GT(moved, 300);
}

TEST(Hazards, ALifetimeThatIsTooShortIsSeen) {
  RandomGraphs random(6);
  int seen = 0;
  for (int i = 0; i < 6000; ++i) {
    CompiledGraph graph = random.next();
    random.prepare(graph);
    const auto lives = livesOf(graph);
    Resource& r = graph.resources[random.below(static_cast<int>(graph.resources.size()))];
    if (!r.transient() || r.firstUse == r.lastUse) continue;
    if (random.below(2) == 0)
      r.lastUse = r.firstUse;
    else
      r.firstUse = r.lastUse;
    planMemory(graph, random.needs(graph));
    planBarriers(graph);
    // Only where it makes a difference to the places.
    const bool wrong = livesTogetherAndShares(graph, lives);
    ASSERT_EQ(!faultOf(graph).empty(), wrong) << faultOf(graph) << "\n"
                                              << r.name << "\n"
                                              << random.json << explain(graph);
    seen += wrong ? 1 : 0;
  }
  EXPECT_GT(seen, 300);
}

}  // namespace
}  // namespace weir::graph::test
