// Quantiles of times, means of frames, seeds of restarts.
#include <gtest/gtest.h>
#include <weir/render/mean.h>
#include <weir/render/render.h>
#include <weir/render/statistics.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

namespace weir::render {
namespace {

TEST(Quantiles, InterpolateBetweenOrderStatistics) {
  std::vector<double> values(101);
  std::iota(values.begin(), values.end(), 0.0);
  std::ranges::reverse(values);
  const Quantiles q = quantiles(values);
  EXPECT_DOUBLE_EQ(q.median, 50.0);
  EXPECT_DOUBLE_EQ(q.p95, 95.0);
  EXPECT_DOUBLE_EQ(q.p99, 99.0);
  const Quantiles two = quantiles({4.0, 2.0});
  EXPECT_DOUBLE_EQ(two.median, 3.0);
  EXPECT_DOUBLE_EQ(two.p95, 3.9);
  const Quantiles one = quantiles({7.0}), none = quantiles({});
  EXPECT_EQ(one.median, 7.0);
  EXPECT_EQ(one.p99, 7.0);
  EXPECT_EQ(none.median, 0.0);
  EXPECT_EQ(none.p99, 0.0);
}

// The first tenth of the frames, at least one, is warm-up: compilers and caches, not the passes.
TEST(Statistics, LeaveTheWarmUpOut) {
  graph::CompiledGraph graph;
  graph.passes.resize(1);
  graph.passes[0].name = "it";
  graph.passes[0].type = "own.It";
  std::vector<execute::FrameTimes> times;
  for (int f = 0; f < 20; ++f) {
    execute::FrameTimes t;
    t.gpu = {f < 2 ? 1000.0 : 5.0};
    t.cpu = {f < 2 ? 1000.0 : 2.0};
    t.gpuFrame = f < 2 ? 1000.0 : 6.0;
    t.cpuFrame = f < 2 ? 1000.0 : 3.0;
    times.push_back(t);
  }
  const auto j = nlohmann::json::parse(statisticsJson(graph, times, {}));
  EXPECT_EQ(j.at("warmup_frames"), 2);
  EXPECT_EQ(j.at("frames"), 20);
  EXPECT_EQ(j.at("passes").at(0).at("gpu_ms").at("p99"), 5.0);
  EXPECT_EQ(j.at("passes").at(0).at("cpu_ms"), 2.0);
  EXPECT_EQ(j.at("frame").at("gpu_ms").at("median"), 6.0);
  EXPECT_EQ(j.at("frame").at("cpu_ms"), 3.0);
  // Two frames have no warm-up to spare, and none at all still make a file.
  times.resize(2);
  EXPECT_EQ(nlohmann::json::parse(statisticsJson(graph, times, {})).at("warmup_frames"), 0);
  EXPECT_EQ(nlohmann::json::parse(statisticsJson(graph, {}, {})).at("frames"), 0);
}

TEST(FrameMean, KeepsDoublePrecision) {
  FrameMean mean;
  // 1 + k·1e-7 in single precision would stand still after a few thousand frames.
  constexpr int kFrames = 20'000;
  for (int f = 0; f < kFrames; ++f) {
    const float small = f % 2 == 0 ? 1e-4f : 3e-4f;
    mean.add({2, 1, {1000.0f, small, -5.0f, 1.0f, static_cast<float>(f), 0, 0, 1.0f}, {}});
  }
  const image::Picture p = mean.mean();
  ASSERT_EQ(p.rgba.size(), 8u);
  EXPECT_EQ(p.width, 2u);
  EXPECT_EQ(p.rgba[0], 1000.0f);
  EXPECT_NEAR(p.rgba[1], 2e-4, 1e-10);
  EXPECT_EQ(p.rgba[2], -5.0f);
  EXPECT_EQ(p.rgba[4], (kFrames - 1) / 2.0f);
}

TEST(FrameMean, TakesEveryNumberOfALargePicture) {
  constexpr uint32_t kWidth = 521, kHeight = 307;  // more than two pieces, the last one smaller
  image::Picture even{kWidth, kHeight, std::vector<float>(size_t{4} * kWidth * kHeight), {}}, odd = even;
  for (size_t i = 0; i < even.rgba.size(); ++i) {
    even.rgba[i] = static_cast<float>(i);
    odd.rgba[i] = static_cast<float>(i) + 2.0f;
  }
  FrameMean mean;
  for (int f = 0; f < 5; ++f) {
    mean.add(even);
    mean.add(odd);
  }
  const image::Picture p = mean.mean();
  for (size_t i = 0; i < p.rgba.size(); ++i) ASSERT_EQ(p.rgba[i], static_cast<float>(i) + 1.0f) << i;
}

TEST(FrameMean, PassesOnWhatIsNotFinite) {
  FrameMean mean;
  mean.add({1, 1, {1.0f, INFINITY, NAN, 1.0f}, {}});
  mean.add({1, 1, {3.0f, 1.0f, 1.0f, 1.0f}, {}});
  const image::Picture p = mean.mean();
  EXPECT_EQ(p.rgba[0], 2.0f);
  EXPECT_TRUE(std::isinf(p.rgba[1]));
  EXPECT_TRUE(std::isnan(p.rgba[2]));
}

// A collision gives two restarts the same picture and halves their weight in the error. 1e4 numbers of 32 bits collide
// with probability 1.2 %; the numbers are the same in every run, and don't.
TEST(RestartSeed, AreDistinctAndKeepTheFirst) {
  for (const uint32_t seed : {0u, 1u, 12345u}) {
    EXPECT_EQ(restartSeed(seed, 0), seed);
    std::set<uint32_t> seen;
    for (uint32_t r = 0; r < 10'000; ++r) seen.insert(restartSeed(seed, r));
    EXPECT_EQ(seen.size(), 10'000u);
  }
  EXPECT_NE(restartSeed(0, 1), restartSeed(1, 1));
  EXPECT_NE(restartSeed(0, 2), restartSeed(1, 1));
}

}  // namespace
}  // namespace weir::render
