#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/core/text.h>
#include <weir/execute/executor.h>
#include <weir/gpu/barrier.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>

namespace weir::execute {
namespace {

using Clock = std::chrono::steady_clock;
double milliseconds(Clock::time_point from) {
  return std::chrono::duration<double, std::milli>(Clock::now() - from).count();
}

constexpr uint64_t kConstantsStride = 256;  // the largest minUniformBufferOffsetAlignment that Vulkan allows
static_assert(sizeof(FrameConstants) <= kConstantsStride);

}  // namespace

GpuCamera toGpu(const scene::Camera& camera, uint32_t width, uint32_t height) {
  const float t = std::tan(camera.verticalFov * 0.5f);
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  const glm::vec3 right = glm::normalize(glm::cross(camera.forward, camera.up));
  const glm::vec3 up = glm::cross(right, camera.forward);
  return {glm::vec4(camera.eye, 0), glm::vec4(camera.forward, 0), glm::vec4(right * t * aspect, 0),
          glm::vec4(up * t, 0)};
}

Executor::Executor(const gpu::Device& device, shader::Compiler& compiler, Registry& registry,
                   const scene::SceneGpu& scene, graph::CompiledGraph graph, const ExecutorOptions& options)
    : device_(device), graph_(std::move(graph)), scene_(scene), resources_(device, graph_) {
  shared_.device = &device_;
  shared_.compiler = &compiler;
  shared_.registry = &registry;
  shared_.scene = &scene_;
  shared_.graph = &graph_;
  shared_.resources = &resources_;
  shared_.backend = scene.hasAcceleration() ? options.backend : trace::Backend::None;
  shared_.countRays = options.countRays;
  shared_.sceneFolder = options.sceneFolder;
  constants_ = gpu::Buffer(device, kSlots * kConstantsStride, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT,
                           gpu::Residency::Upload, "frame constants");
  rayCounter_ = gpu::Buffer(device, sizeof(uint32_t), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Residency::Readback,
                            "ray counter");
  try {
    makeSceneSets(compiler);
    for (const graph::CompiledPass& pass : graph_.passes)
      passes_.push_back(std::make_unique<PassRuntime>(shared_, pass));
    makeSlots();
  } catch (...) {
    freeSceneSets();
    throw;
  }
}

void Executor::makeSceneSets(shader::Compiler& compiler) {
  if (!scene_.traits.animated) {
    sceneSets_[0] = sceneSets_[1] = scene_.makeSet(constants_, sizeof(FrameConstants), rayCounter_);
    shared_.draws = &scene_.draws;
    return;
  }
  motion_ = std::make_unique<SceneMotion>(device_, compiler, scene_);
  for (uint32_t parity = 0; parity < 2; ++parity) {
    const scene::MovingBindings moving = motion_->bindings(parity);
    sceneSets_[parity] = scene_.makeSet(constants_, sizeof(FrameConstants), rayCounter_, &moving);
  }
  shared_.draws = &motion_->draws();
}

void Executor::freeSceneSets() {
  if (sceneSets_[1] != sceneSets_[0]) scene_.freeSet(sceneSets_[1]);
  scene_.freeSet(sceneSets_[0]);
}

Executor::~Executor() {
  vkDeviceWaitIdle(device_.handle());
  for (Slot& s : slots_) {
    vkDestroyQueryPool(device_.handle(), s.queries, nullptr);
    vkDestroyFence(device_.handle(), s.fence, nullptr);
    vkDestroyCommandPool(device_.handle(), s.pool, nullptr);
  }
  passes_.clear();
  freeSceneSets();
}

void Executor::makeSlots() {
  for (Slot& s : slots_) {
    VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    pool.queueFamilyIndex = device_.queueFamily();
    gpu::check(vkCreateCommandPool(device_.handle(), &pool, nullptr, &s.pool), "vkCreateCommandPool");
    VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    allocate.commandPool = s.pool;
    allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    allocate.commandBufferCount = 1;
    gpu::check(vkAllocateCommandBuffers(device_.handle(), &allocate, &s.commands), "vkAllocateCommandBuffers");
    const VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    gpu::check(vkCreateFence(device_.handle(), &fence, nullptr, &s.fence), "vkCreateFence");
    if (device_.capabilities().timestampPeriod > 0) {
      VkQueryPoolCreateInfo queries{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
      queries.queryType = VK_QUERY_TYPE_TIMESTAMP;
      queries.queryCount = static_cast<uint32_t>(graph_.passes.size() + 2);
      gpu::check(vkCreateQueryPool(device_.handle(), &queries, nullptr, &s.queries), "vkCreateQueryPool");
    }
  }
}

void Executor::stamp(const Slot& slot, uint32_t query) const {
  if (slot.queries == VK_NULL_HANDLE) return;
  vkCmdWriteTimestamp2(slot.commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, slot.queries, query);
}

void Executor::collect(Slot& slot) {
  if (!slot.busy) return;
  gpu::check(vkWaitForFences(device_.handle(), 1, &slot.fence, VK_TRUE, std::numeric_limits<uint64_t>::max()),
             "vkWaitForFences");
  gpu::check(vkResetFences(device_.handle(), 1, &slot.fence), "vkResetFences");
  slot.busy = false;
  if (slot.queries != VK_NULL_HANDLE) {
    std::vector<uint64_t> ticks(passes_.size() + 2);  // the scene's start, then the passes'; the end
    gpu::check(
        vkGetQueryPoolResults(device_.handle(), slot.queries, 0, static_cast<uint32_t>(ticks.size()), ticks.size() * 8,
                              ticks.data(), 8, VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
        "vkGetQueryPoolResults");
    const double period = device_.capabilities().timestampPeriod * 1e-6;
    slot.times.gpuScene = static_cast<double>(ticks[1] - ticks[0]) * period;
    for (size_t i = 1; i + 1 < ticks.size(); ++i)
      slot.times.gpu.push_back(static_cast<double>(ticks[i + 1] - ticks[i]) * period);
    slot.times.gpuFrame = static_cast<double>(ticks.back() - ticks.front()) * period;
  }
  times_.push_back(std::move(slot.times));
  slot.times = {};
  rayCounter_.invalidate();
  uint32_t count = 0;
  std::memcpy(&count, rayCounter_.mapped(), sizeof count);
  rays_ = shared_.countRays ? count : 0;
}

void Executor::writeConstants(const FrameInput& input, uint32_t slot) {
  FrameConstants c;
  c.camera = toGpu(input.camera, graph_.width, graph_.height);
  c.previousCamera = clearNext_ ? c.camera : previousCamera_;
  previousCamera_ = c.camera;
  c.width = graph_.width;
  c.height = graph_.height;
  c.frame = input.index;
  c.seed = input.seed;
  c.lights = scene_.lightCount;
  c.instances = scene_.instanceCount;
  c.sceneDiameter = motion_ ? motion_->diameter() : scene_.diameter;
  c.sceneLargest = motion_ ? motion_->largestSide() : scene_.largestSide;
  // Depth is near/z in 32-bit floats, so that a near plane this close costs no precision.
  c.sceneNear = c.sceneDiameter * 0x1p-20f;
  std::memcpy(constants_.mapped() + slot * kConstantsStride, &c, sizeof c);
  constants_.flush();
}

/// The planned barriers of a pass, all in one: what they wait for, and what waits.
void Executor::beforePass(VkCommandBuffer commands, size_t pass) const {
  VkPipelineStageFlags2 before = 0;
  VkAccessFlags2 beforeAccess = 0, afterAccess = 0;
  for (const graph::Barrier& b : graph_.passes[pass].barriers) {
    // What an earlier frame did can have been done by any pass.
    if (b.fromPass != graph::kNone) {
      before |= passes_[b.fromPass]->stages();
    } else {
      for (const auto& p : passes_) before |= p->stages();
      before |= VK_PIPELINE_STAGE_2_TRANSFER_BIT;
      if (b.before == graph::Access::Write) beforeAccess |= VK_ACCESS_2_TRANSFER_WRITE_BIT;
    }
    if (b.before == graph::Access::Write) beforeAccess |= VK_ACCESS_2_SHADER_WRITE_BIT;
    afterAccess |= b.after == graph::Access::Write ? VK_ACCESS_2_SHADER_WRITE_BIT : VK_ACCESS_2_SHADER_READ_BIT;
  }
  if (passes_[pass]->hasScratch()) {  // last frame's launches still use it
    before |= passes_[pass]->stages();
    beforeAccess |= VK_ACCESS_2_SHADER_WRITE_BIT;
    afterAccess |= VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_SHADER_WRITE_BIT;
  }
  if (before != 0 && passes_[pass]->stages() != 0) {
    gpu::memoryBarrier(commands, before, beforeAccess, passes_[pass]->stages(), afterAccess);
  }
}

void Executor::record(Slot& slot, uint32_t slotIndex, const FrameInput& input) {
  gpu::check(vkResetCommandPool(device_.handle(), slot.pool, 0), "vkResetCommandPool");
  VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  gpu::check(vkBeginCommandBuffer(slot.commands, &begin), "vkBeginCommandBuffer");
  if (slot.queries != VK_NULL_HANDLE) {
    vkCmdResetQueryPool(slot.commands, slot.queries, 0, static_cast<uint32_t>(passes_.size() + 2));
  }
  const auto parity = static_cast<uint32_t>(frames_ & 1u);
  stamp(slot, 0);
  if (motion_) {
    device_.beginLabel(slot.commands, "scene");
    motion_->record(slot.commands, slotIndex, parity, input.state, clearNext_);
    device_.endLabel(slot.commands);
  }
  writeConstants(input, slotIndex);
  if (clearNext_) {
    const VkAccessFlags2 any = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
    gpu::memoryBarrier(slot.commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, any, VK_PIPELINE_STAGE_2_TRANSFER_BIT, any);
    resources_.clearHistory(slot.commands);
    gpu::memoryBarrier(slot.commands, VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                       VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, any);
    clearNext_ = false;
  }
  FrameCursor cursor{slot.commands, sceneSets_[parity], static_cast<uint32_t>(slotIndex * kConstantsStride), parity};
  device_.beginLabel(slot.commands, fmt::format("{} frame {}", graph_.name, input.index));
  stamp(slot, 1);
  for (size_t i = 0; i < passes_.size(); ++i) {
    const Clock::time_point start = Clock::now();
    device_.beginLabel(slot.commands, graph_.passes[i].name);
    beforePass(slot.commands, i);
    passes_[i]->record(cursor);
    device_.endLabel(slot.commands);
    stamp(slot, static_cast<uint32_t>(i + 2));
    slot.times.cpu.push_back(milliseconds(start));
  }
  device_.endLabel(slot.commands);
  gpu::check(vkEndCommandBuffer(slot.commands), "vkEndCommandBuffer");
}

void Executor::frame(const FrameInput& input) {
  const auto slotIndex = static_cast<uint32_t>(frames_ % kSlots);
  Slot& slot = slots_[slotIndex];
  collect(slot);  // waits for the frame before last: no work of this one's
  if (shared_.countRays) {
    finish();
    std::memset(rayCounter_.mapped(), 0, sizeof(uint32_t));
    rayCounter_.flush();
  }
  const Clock::time_point start = Clock::now();
  if (input.cut) clearNext_ = true;
  record(slot, slotIndex, input);
  VkCommandBufferSubmitInfo commands{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
  commands.commandBuffer = slot.commands;
  VkSubmitInfo2 submit{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
  submit.commandBufferInfoCount = 1;
  submit.pCommandBufferInfos = &commands;
  gpu::check(vkQueueSubmit2(device_.queue(), 1, &submit, slot.fence), "vkQueueSubmit2");
  slot.busy = true;
  slot.times.cpuFrame = milliseconds(start);
  ++frames_;
}

void Executor::finish() {
  for (uint64_t i = 0; i < kSlots; ++i) collect(slots_[(frames_ + i) % kSlots]);  // oldest first
}

std::vector<FrameTimes> Executor::takeTimes() {
  std::vector<FrameTimes> result(std::make_move_iterator(times_.begin()), std::make_move_iterator(times_.end()));
  times_.clear();
  return result;
}

uint64_t Executor::transientBytes() const {
  uint64_t sum = resources_.transientBytes();
  for (const auto& p : passes_) sum += p->scratchBytes();
  return sum;
}

}  // namespace weir::execute
