#include "view/compare/warm_up.h"

#include <fmt/format.h>
#include <weir/execute/scene_frame.h>

#include <algorithm>
#include <string_view>
#include <variant>

namespace weir::view {
namespace {

constexpr uint64_t kUsual = 40, kMost = 512;

/// The longest memory that the pass says it has, in frames; 0: none.
uint64_t memoryOf(const graph::CompiledPass& pass, std::string& name) {
  uint64_t longest = 0;
  if (std::ranges::none_of(pass.inputs, &graph::Binding::previous)) return longest;
  for (const ParamDescription& param : pass.description->params) {
    const auto value = pass.params.find(param.name);
    if (param.unit != "frames" || value == pass.params.end()) continue;
    const auto* frames = std::get_if<int32_t>(&value->second);
    if (frames == nullptr || *frames <= 0 || static_cast<uint64_t>(*frames) <= longest) continue;
    longest = static_cast<uint64_t>(*frames);
    name = pass.name + "." + param.name;
  }
  return longest;
}

}  // namespace

WarmUp warmUpOf(const graph::CompiledGraph& graph) {
  constexpr uint64_t kInFlight = execute::SceneFrame::kSlots;
  if (std::ranges::none_of(graph.resources, &graph::Resource::history))
    return {kInFlight, "they were in flight when it changed"};
  uint64_t longest = 0;
  std::string longestName;
  for (const graph::CompiledPass& pass : graph.passes) {
    std::string name;
    const uint64_t memory = memoryOf(pass, name);
    if (memory <= longest) continue;
    longest = memory;
    longestName = name;
  }
  if (longest == 0) return {kUsual, "the history fills"};
  return {std::min(2 * longest, kMost), fmt::format("the history fills ({} is {})", longestName, longest)};
}

}  // namespace weir::view
