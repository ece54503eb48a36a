// What it costs Weir itself to record a frame: Vulkan's commands are replaced by functions that do nothing, so that
// what is left is ours.
#include <weir/core/error.h>
#include <weir/execute/graph_runtime.h>
#include <weir/gpu/vulkan.h>
#include <weir/graph/compile.h>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <exception>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace weir::bench {
namespace {

/// A function of Vulkan's that does nothing, in the place of the real one for as long as this lives.
template <auto& Function>
class Silenced {
 public:
  Silenced() : real_(std::exchange(Function, nothing(Function))) {}
  ~Silenced() { Function = real_; }
  Silenced(const Silenced&) = delete;
  Silenced& operator=(const Silenced&) = delete;

 private:
  template <typename... Arguments>
  static auto nothing(void (*)(Arguments...)) -> void (*)(Arguments...) {
    return [](Arguments...) {};
  }
  std::remove_reference_t<decltype(Function)> real_;
};

struct SilentDriver {
  Silenced<vkCmdPipelineBarrier2> barrier;
  Silenced<vkCmdClearColorImage> clearImage;  // the first frame clears history
  Silenced<vkCmdFillBuffer> fillBuffer;
  Silenced<vkCmdBindPipeline> bindPipeline;
  Silenced<vkCmdBindDescriptorSets> bindSets;
  Silenced<vkCmdPushConstants> push;
  Silenced<vkCmdDispatch> dispatch;
  Silenced<vkCmdTraceRaysKHR> trace;
  Silenced<vkCmdWriteTimestamp2> timestamp;
  Silenced<vkCmdResetQueryPool> resetQueries;
  Silenced<vkCmdBeginDebugUtilsLabelEXT> beginLabel;
  Silenced<vkCmdEndDebugUtilsLabelEXT> endLabel;
};

/// A chain of passes, each reading the one before and, every fourth, also last frame's value of the one after that.
std::string chain(int passes) {
  std::string text;
  for (int p = 0; p < passes; ++p) {
    const std::string color =
        p == 0 ? fmt::format("p{:03}.color@previous", passes - 1) : fmt::format("p{:03}.color", p - 1);
    text += fmt::format(R"({}"p{:03}": {{"type": "template.Scale", "inputs": {{"color": "{}"}}}})", p == 0 ? "" : ", ",
                        p, color);
  }
  return fmt::format(R"({{"version": 1, "passes": {{{}}}, "outputs": {{"o": "p{:03}.color"}}}})", text, passes - 1);
}

struct Machine {
  gpu::Device device{gpu::DeviceOptions{.choice = "cpu"}};
  Registry registry{{std::filesystem::path(WEIR_BINARY_DIR) / "bin"}};
  shader::Compiler compiler;
  execute::PipelineLibrary pipelines;
  scene::Scene source;
  scene::PreparedScene prepared = scene::prepareScene(source);
  scene::SceneGpu scene{device, source, prepared, false};
  execute::SceneFrame frame{device, compiler, scene};
};

void recordGraph(benchmark::State& state) {
  try {
    Machine machine;
    std::vector<graph::Diagnostic> diagnostics;
    const int passes = static_cast<int>(state.range(0));
    const graph::Description description = graph::parse(chain(passes), "bench.json", diagnostics);
    graph::CompiledGraph compiled = graph::compile(description, machine.registry.catalog(), 64, 64, diagnostics);
    if (!diagnostics.empty()) return state.SkipWithError(diagnostics.front().text().c_str());
    const execute::Services services{&machine.device, &machine.compiler, &machine.registry, &machine.pipelines};
    execute::GraphRuntime runtime(services, machine.frame, std::move(compiled), {});
    std::vector<double> cpu(runtime.graph().passes.size());
    const SilentDriver silent;
    // Timestamps are written as in a real frame: any handle that is not null will do.
    const execute::Stamps stamps{reinterpret_cast<VkQueryPool>(uintptr_t{1}), cpu};
    uint32_t slot = 0;
    for (auto _ : state) {
      runtime.record(VK_NULL_HANDLE, {}, slot, stamps);
      slot = 1 - slot;
    }
    state.SetItemsProcessed(state.iterations() * passes);
  } catch (const std::exception& error) {
    state.SkipWithError(error.what());
  }
}

BENCHMARK(recordGraph)->Name("record")->Arg(10)->Arg(100)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace weir::bench
