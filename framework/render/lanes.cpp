#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/execute/scene_frame.h>
#include <weir/gpu/memory.h>
#include <weir/render/lanes.h>

#include <algorithm>
#include <charconv>

namespace weir::render {

uint32_t parseLanes(const std::string& words) {
  if (words == "auto") return 0;
  uint32_t lanes = 0;
  const char* end = words.data() + words.size();
  const auto parsed = std::from_chars(words.data(), end, lanes);
  if (parsed.ec != std::errc() || parsed.ptr != end || lanes == 0 || lanes > execute::SceneFrame::kMostLanes)
    throw InputError(
        fmt::format("--lanes {}: must be auto or 1 … {} restarts at a time", words, execute::SceneFrame::kMostLanes));
  return lanes;
}

uint32_t lanesThatFill(const gpu::Device& device, const graph::CompiledGraph& graph) {
  constexpr uint64_t kPixels = uint64_t{1} << 22, kMost = 16;
  // A CPU's cores are busy with one picture, and its caches hold one better than several.
  if (device.info().kind == "cpu") return 1;
  const uint64_t pixels = std::max<uint64_t>(1, uint64_t{graph.width} * graph.height);
  const uint64_t filling = std::min((kPixels + pixels - 1) / pixels, kMost);
  const uint64_t bytes = std::max<uint64_t>(1, graph.transientBytes() + graph.historyBytes());
  const uint64_t fitting = gpu::freeDeviceBytes(device) / 4 / bytes;
  return static_cast<uint32_t>(std::max<uint64_t>(1, std::min(filling, fitting)));
}

}  // namespace weir::render
