#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/core/stopwatch.h>
#include <weir/core/text.h>
#include <weir/execute/graph_runtime.h>
#include <weir/gpu/barrier.h>

#include <algorithm>
#include <utility>

namespace weir::execute {
namespace {

uint64_t largestAllocation(const gpu::Device& device) {
  VkPhysicalDeviceMaintenance3Properties limits{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
  properties.pNext = &limits;
  vkGetPhysicalDeviceProperties2(device.physical(), &properties);
  return limits.maxMemoryAllocationSize;
}

bool sameBinding(const graph::Binding& a, const graph::Binding& b) {
  return a.port == b.port && a.resource == b.resource && a.previous == b.previous;
}

bool sameBindings(const std::vector<graph::Binding>& a, const std::vector<graph::Binding>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), sameBinding);
}

bool sameResource(const graph::Resource& a, const graph::Resource& b) {
  return a.name == b.name && compatible(a.type, b.type) && a.width == b.width && a.height == b.height &&
         a.elements == b.elements && a.bytes == b.bytes && a.history == b.history && a.external == b.external &&
         a.kept == b.kept && a.firstUse == b.firstUse && a.lastUse == b.lastUse;
}

bool sameOutput(const graph::GraphOutput& a, const graph::GraphOutput& b) {
  return a.name == b.name && a.resource == b.resource && a.previous == b.previous;
}

}  // namespace

GraphRuntime::GraphRuntime(const Services& services, SceneFrame& scene, graph::CompiledGraph graph,
                           const ExecutorOptions& options, const GraphRuntime* before)
    : device_(*services.device),
      scene_(scene),
      graph_(std::move(graph)),
      share_(options.shareMemory),
      poison_(options.poison) {
  // What another runtime added to a graph that was taken from it.
  std::erase_if(graph_.resources, [](const graph::Resource& r) { return r.scratch; });
  for (graph::CompiledPass& pass : graph_.passes) pass.scratch.clear();
  shared_.services = services;
  shared_.frame = &scene_;
  shared_.graph = &graph_;
  shared_.backend = scene.scene().hasAcceleration() ? options.backend : trace::Backend::None;
  shared_.countRays = options.countRays;
  shared_.sceneFolder = options.sceneFolder;
  for (uint32_t p = 0; p < graph_.passes.size(); ++p) {
    passes_.push_back(std::make_unique<PassRuntime>(shared_, p));
    passes_.back()->prepare();
    graph_.passes[p].stages = passes_.back()->stages();
  }
  checkLimits(device_, graph_);
  // Only now is it known what scratch memory there is and which stages passes run in.
  planMemory(graph_, deviceNeeds(device_, graph_), share_, largestAllocation(device_));
  planBarriers(graph_);
  for (const graph::Resource& r : graph_.resources) external_ |= r.external;
  if (external_ && scene_.lanes() > 1)
    throw InputError(fmt::format("graph '{}' takes resources from its host: there is one lane of it, not {}",
                                 graph_.name, scene_.lanes()));
  for (uint32_t lane = 0; lane < scene_.lanes(); ++lane)
    lanes_.push_back(std::make_unique<Resources>(device_, graph_, before ? before->lanes_[lane].get() : nullptr));
  for (const auto& pass : passes_) pass->bind(lanes_, external_);
  makeBarriers();
}

GraphRuntime::~GraphRuntime() = default;

bool GraphRuntime::update(const graph::CompiledGraph& graph) {
  // Behind the graph's own resources stand the scratch resources that passes added here.
  if (graph.width != graph_.width || graph.height != graph_.height || graph.passes.size() != graph_.passes.size() ||
      graph.resources.size() > graph_.resources.size())
    return false;
  for (size_t r = 0; r < graph_.resources.size(); ++r) {
    const graph::Resource& mine = graph_.resources[r];
    if (r < graph.resources.size() ? mine.scratch || !sameResource(mine, graph.resources[r]) : !mine.scratch)
      return false;
  }
  if (!std::equal(graph.outputs.begin(), graph.outputs.end(), graph_.outputs.begin(), graph_.outputs.end(), sameOutput))
    return false;
  for (size_t p = 0; p < passes_.size(); ++p) {
    const graph::CompiledPass &mine = graph_.passes[p], &wanted = graph.passes[p];
    if (mine.name != wanted.name || mine.type != wanted.type || mine.description != wanted.description ||
        !sameBindings(mine.inputs, wanted.inputs) || !sameBindings(mine.outputs, wanted.outputs) ||
        !passes_[p]->accepts(wanted))
      return false;
  }
  for (size_t p = 0; p < passes_.size(); ++p) passes_[p]->take(graph.passes[p]);
  graph_.name = graph.name;
  graph_.file = graph.file;
  graph_.skipped = graph.skipped;
  return true;
}

void GraphRuntime::setExternal(const std::string& name, uint32_t slot, Storage storage) {
  if (slot >= SceneFrame::kSlots)
    throw InputError(fmt::format("slot {} of '{}': there are {} frames in flight", slot, name, SceneFrame::kSlots));
  std::vector<std::string> names;
  for (uint32_t r = 0; r < graph_.resources.size(); ++r) {
    const graph::Resource& resource = graph_.resources[r];
    if (!resource.external) continue;
    names.push_back(resource.name);
    if (resource.name != name) continue;
    if (static_cast<bool>(storage.image) != resource.isImage())
      throw InputError(fmt::format("'{}' is {}", name, describe(resource.type)));
    lanes_[0]->setExternal(r, slot, std::move(storage));
    for (const auto& pass : passes_) pass->rebind(slot, r);
    return;
  }
  const std::string nearest = nearestName(name, names);
  throw InputError(fmt::format("graph '{}' expects no resource '{}' of the host{}", graph_.name, name,
                               nearest.empty() ? "" : fmt::format(" (nearest: '{}')", nearest)));
}

/// What the host provides and nobody reads need not be there.
bool GraphRuntime::needsExternal(uint32_t resource) const {
  const graph::Resource& r = graph_.resources[resource];
  if (!r.external || r.producer != graph::kNone) return r.external;
  return std::any_of(graph_.passes.begin(), graph_.passes.end(), [&](const graph::CompiledPass& pass) {
    return std::any_of(pass.inputs.begin(), pass.inputs.end(),
                       [&](const graph::Binding& b) { return b.resource == resource; });
  });
}

void GraphRuntime::checkExternals(uint32_t slot) const {
  for (uint32_t r = 0; r < graph_.resources.size(); ++r)
    if (needsExternal(r) && !lanes_[0]->external(r, slot))
      throw InputError(fmt::format("graph '{}' is recorded without the host's resource '{}' for slot {}", graph_.name,
                                   graph_.resources[r].name, slot));
}

void GraphRuntime::makeBarriers() {
  barriers_.resize(graph_.passes.size());
  for (size_t p = 0; p < graph_.passes.size(); ++p) {
    const graph::CompiledPass& pass = graph_.passes[p];
    for (const graph::Wait& w : pass.waits) {
      VkMemoryBarrier2& b = barriers_[p].memory.emplace_back(VkMemoryBarrier2{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2});
      b.srcStageMask = vulkanStages(w.from);
      b.srcAccessMask = w.writes ? writeAccess(w.from) : 0;
      b.dstStageMask = vulkanStages(w.to);
      b.dstAccessMask = (w.toReads ? readAccess(w.to) : 0) | (w.toWrites ? writeAccess(w.to) : 0);
    }
    for (const auto& lane : lanes_)
      for (const graph::ImageStart& s : pass.starts) {
        VkImageMemoryBarrier2& b = barriers_[p].images.emplace_back(toGeneral(lane->at(s.resource, 0, false).image));
        b.srcStageMask = vulkanStages(s.from);
        // What this image itself was written with in the last frame is made available before its content is dropped.
        // What others wrote into the memory, the waits make available.
        b.srcAccessMask = readAccess(s.from) | writeAccess(s.from);
        b.dstStageMask = vulkanStages(pass.stages);
        b.dstAccessMask = readAccess(pass.stages) | writeAccess(pass.stages);
      }
  }
}

void GraphRuntime::beforePass(VkCommandBuffer commands, size_t pass) const {
  const Barriers& b = barriers_[pass];
  if (b.memory.empty() && b.images.empty()) return;
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.memoryBarrierCount = static_cast<uint32_t>(b.memory.size());
  info.pMemoryBarriers = b.memory.data();
  info.imageMemoryBarrierCount = static_cast<uint32_t>(b.images.size() / lanes_.size() * scene_.active());
  info.pImageMemoryBarriers = b.images.data();
  vkCmdPipelineBarrier2(commands, &info);
}

bool GraphRuntime::hasFreshHistory() const {
  return std::any_of(lanes_.begin(), lanes_.begin() + scene_.active(),
                     [](const auto& lane) { return lane->hasFresh(); });
}

void GraphRuntime::clearHistory(VkCommandBuffer commands) {
  const VkAccessFlags2 any = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
  gpu::memoryBarrier(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, any, VK_PIPELINE_STAGE_2_TRANSFER_BIT, any);
  for (uint32_t lane = 0; lane < scene_.active(); ++lane) lanes_[lane]->clearHistory(commands, scene_.fresh());
  gpu::memoryBarrier(commands, VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                     VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, any);
}

/// Before a pass what it is about to write, after it what it was the last to use.
void GraphRuntime::poisonAround(VkCommandBuffer commands, uint32_t pass, bool before) const {
  gpu::fullBarrier(commands);
  for (uint32_t i = 0; i < graph_.resources.size(); ++i) {
    const graph::Resource& r = graph_.resources[i];
    const bool looked = r.graphOutput || r.kept;
    if (!r.transient() || (before ? r.firstUse != pass : r.lastUse != pass || looked)) continue;
    for (uint32_t lane = 0; lane < scene_.active(); ++lane) execute::poison(commands, lanes_[lane]->at(i, 0, false), r);
  }
  gpu::fullBarrier(commands);
}

void GraphRuntime::record(VkCommandBuffer commands, const FrameInput& input, uint32_t slot, const Stamps& stamps) {
  if (external_) checkExternals(slot);
  const auto stamp = [&](size_t query) {
    if (stamps.queries != VK_NULL_HANDLE)
      vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, stamps.queries,
                           stamps.firstQuery + static_cast<uint32_t>(query));
  };
  if (stamps.queries != VK_NULL_HANDLE)
    vkCmdResetQueryPool(commands, stamps.queries, stamps.firstQuery, static_cast<uint32_t>(passes_.size() + 2));
  stamp(0);
  device_.beginLabel(commands, graph_.name.c_str());
  scene_.begin(commands, input, slot, graph_.width, graph_.height);
  // What the graph before this one left behind was made visible by its barriers, not by this one's.
  if (!recorded_) gpu::fullBarrier(commands);
  if (scene_.fresh() || hasFreshHistory()) clearHistory(commands);
  const FrameCursor cursor{commands, scene_.set(),    scene_.constantsOffset(slot),
                           slot,     scene_.parity(), scene_.active()};
  stamp(1);
  for (uint32_t p = 0; p < passes_.size(); ++p) {
    const Clock::time_point start = Clock::now();
    device_.beginLabel(commands, graph_.passes[p].name.c_str());
    beforePass(commands, p);
    if (poison_) poisonAround(commands, p, true);
    passes_[p]->record(cursor);
    if (poison_) poisonAround(commands, p, false);
    device_.endLabel(commands);
    stamp(p + 2);
    if (p < stamps.cpu.size()) stamps.cpu[p] = millisecondsSince(start);
  }
  device_.endLabel(commands);
  // Only now: a frame whose recording threw never was.
  scene_.end();
  for (uint32_t lane = 0; lane < scene_.active(); ++lane) lanes_[lane]->setCleared();
  recorded_ = true;
}

VkPipelineStageFlags2 GraphRuntime::stages() const {
  graph::Stages all = 0;
  for (const graph::CompiledPass& pass : graph_.passes) all |= pass.stages;
  return vulkanStages(all);
}

}  // namespace weir::execute
