#include <weir/render/bench_measure.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace weir::render {
namespace {

uint64_t bytesOf(const graph::CompiledGraph& graph, const std::vector<graph::Binding>& ports) {
  uint64_t bytes = 0;
  for (const graph::Binding& port : ports)
    if (port.resource != graph::kNone) bytes += graph.resources[port.resource].bytes;
  return bytes;
}

template <typename Value>
Quantiles over(const std::vector<execute::FrameTimes>& times, const Value& value) {
  std::vector<double> values;
  values.reserve(times.size());
  for (const execute::FrameTimes& t : times) values.push_back(value(t));
  return quantiles(std::move(values));
}

bool timed(const std::vector<execute::FrameTimes>& times) {
  return !times.empty() && !times.front().gpu.empty();
}

}  // namespace

std::vector<PassMeasure> passMeasures(const graph::CompiledGraph& graph,
                                      const std::vector<execute::FrameTimes>& times) {
  std::vector<PassMeasure> result;
  for (size_t p = 0; p < graph.passes.size(); ++p) {
    const graph::CompiledPass& pass = graph.passes[p];
    PassMeasure m{pass.name, pass.type, {}, 0.0, bytesOf(graph, pass.inputs), bytesOf(graph, pass.outputs)};
    if (timed(times)) m.gpuMs = over(times, [&](const auto& t) { return t.gpu[p]; });
    m.cpuMs = over(times, [&](const auto& t) { return t.cpu[p]; }).median;
    result.push_back(std::move(m));
  }
  return result;
}

CostMeasure measureCost(execute::Executor& executor, const Stage& stage, const BenchSettings& settings) {
  using Clock = std::chrono::steady_clock;
  Player player(stage);
  std::vector<execute::FrameTimes> times;
  times.reserve(settings.frames + execute::Executor::kTimesKept);
  executor.resetHistory();
  uint32_t number = settings.firstFrame;
  for (uint32_t f = 0; f < settings.warmup; ++f) executor.frame(player.frame(number++, settings.seed));
  // From here to the end the loop is in its steady state: each call waits for the frame before last.
  const Clock::time_point start = Clock::now();
  for (uint32_t f = 0; f < settings.frames; ++f) {
    executor.frame(player.frame(number++, settings.seed));
    if (f % (execute::Executor::kTimesKept / 2) == 0)
      for (execute::FrameTimes& t : executor.takeTimes()) times.push_back(std::move(t));
  }
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  executor.finish();
  for (execute::FrameTimes& t : executor.takeTimes()) times.push_back(std::move(t));
  // Those of the warm-up come first.
  times.erase(times.begin(), times.end() - std::min<std::ptrdiff_t>(std::ssize(times), settings.frames));

  CostMeasure cost;
  cost.passes = passMeasures(executor.graph(), times);
  if (timed(times)) cost.frameGpuMs = over(times, [](const auto& t) { return t.gpuFrame; });
  cost.frameCpuMs = over(times, [](const auto& t) { return t.cpuFrame; }).median;
  cost.wallMs = 1000.0 * seconds / settings.frames;
  cost.transientBytes = executor.transientBytes();
  cost.historyBytes = executor.historyBytes();
  cost.savedBytes = executor.savedBytes();
  cost.sceneBytes = executor.motionBytes();
  return cost;
}

uint64_t countRays(execute::Executor& counting, const Stage& stage, const BenchSettings& settings) {
  Player player(stage);
  counting.resetHistory();
  for (uint32_t f = 0; f < 3; ++f) counting.frame(player.frame(settings.firstFrame + f, settings.seed));
  counting.finish();
  return counting.rays();
}

}  // namespace weir::render
