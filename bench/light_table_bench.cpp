// What it costs the device to build the alias table of lights whose powers change (execute/light_table.h), by its own
// clock. WEIR_BENCH_DEVICE chooses the device as --device does; unset: as weir chooses by itself.
#include <weir/execute/light_table.h>
#include <weir/gpu/device.h>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <memory>
#include <string>
#include <vector>

namespace weir::bench {
namespace {

/// Two timestamps.
class Clock {
 public:
  explicit Clock(const gpu::Device& device) : device_(device) {
    VkQueryPoolCreateInfo info{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
    info.queryType = VK_QUERY_TYPE_TIMESTAMP;
    info.queryCount = 2;
    gpu::check(vkCreateQueryPool(device.handle(), &info, nullptr, &pool_), "vkCreateQueryPool");
  }
  ~Clock() { vkDestroyQueryPool(device_.handle(), pool_, nullptr); }
  Clock(const Clock&) = delete;
  Clock& operator=(const Clock&) = delete;

  template <typename Record>
  double milliseconds(const Record& record) const {
    device_.submitAndWait([&](VkCommandBuffer commands) {
      vkCmdResetQueryPool(commands, pool_, 0, 2);
      gpu::fullBarrier(commands);
      vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool_, 0);
      record(commands);
      vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool_, 1);
    });
    std::array<uint64_t, 2> ticks{};
    gpu::check(vkGetQueryPoolResults(device_.handle(), pool_, 0, 2, sizeof ticks, ticks.data(), 8,
                                     VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
               "vkGetQueryPoolResults");
    return static_cast<double>(ticks[1] - ticks[0]) * device_.capabilities().timestampPeriod * 1e-6;
  }

 private:
  const gpu::Device& device_;
  VkQueryPool pool_ = VK_NULL_HANDLE;
};

/// Areas of a mesh's triangles: near each other in size, with a tail to both sides.
std::vector<float> powersOf(uint32_t lights) {
  std::vector<float> powers(lights);
  uint32_t state = 1;
  for (float& power : powers) {
    float sum = 0.0f;
    for (int i = 0; i < 4; ++i) {
      state = state * 1664525u + 1013904223u;
      sum += static_cast<float>(state >> 8u) * 0x1p-24f;
    }
    power = std::exp(2.0f * sum);
  }
  return powers;
}

std::unique_ptr<gpu::Device> chosenDevice() {
  gpu::DeviceOptions options;
  if (const char* choice = std::getenv("WEIR_BENCH_DEVICE")) options.choice = choice;
  return std::make_unique<gpu::Device>(options);
}

void lightTable(benchmark::State& state) {
  try {
    const std::unique_ptr<gpu::Device> device = chosenDevice();
    if (!execute::LightTable::supported(*device) || !(device->capabilities().timestampPeriod > 0.0f)) {
      state.SkipWithError("the device has no double precision in shaders, or no clock");
      return;
    }
    const auto lights = static_cast<uint32_t>(state.range(0));
    constexpr VkBufferUsageFlags kStorage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
    const gpu::Buffer powers = gpu::uploadBuffer(*device, powersOf(lights), kStorage, "powers");
    const gpu::Buffer cells(*device, uint64_t{8} * lights, kStorage, gpu::Residency::Device, "cells");
    // Beside the rest of a light, as in the scene.
    const gpu::Buffer pdfs(*device, uint64_t{64} * lights, kStorage, gpu::Residency::Device, "lights");
    shader::Compiler compiler;
    const execute::LightTable table(*device, compiler, lights, powers.handle(), cells.handle(),
                                    {{pdfs.handle(), 16, 7}});
    const Clock clock(*device);
    const auto build = [&](VkCommandBuffer commands) { table.record(commands, 0); };
    clock.milliseconds(build);
    std::vector<double> all;
    for (auto _ : state) {
      all.push_back(clock.milliseconds(build));
      state.SetIterationTime(all.back() * 1e-3);
    }
    std::sort(all.begin(), all.end());
    state.counters["median_ms"] = all[all.size() / 2];
    state.counters["p95_ms"] = all[all.size() * 95 / 100];
    state.SetLabel(device->info().name);
  } catch (const std::exception& error) {
    state.SkipWithError(error.what());
  }
}
BENCHMARK(lightTable)
    ->Name("light_table")
    ->Arg(1000)
    ->Arg(100000)
    ->Arg(1000000)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace weir::bench
