#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/core/stopwatch.h>
#include <weir/execute/executor.h>
#include <weir/gpu/barrier.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

namespace weir::execute {
Executor::Executor(const gpu::Device& device, shader::Compiler& compiler, Registry& registry,
                   const scene::SceneGpu& scene, graph::CompiledGraph graph, const ExecutorOptions& options)
    : device_(device),
      options_(options),
      services_{&device, &compiler, &registry, &pipelines_, &shaderFiles_},
      scene_(device, compiler, scene, options.lanes),
      source_(std::move(graph)) {
  runtime_ = std::make_unique<GraphRuntime>(services_, scene_, source_, options_);
  try {
    makeSlots();
  } catch (...) {
    freeSlots();
    throw;
  }
}

Executor::~Executor() {
  vkDeviceWaitIdle(device_.handle());
  freeSlots();
}

void Executor::freeSlots() {
  for (Slot& s : slots_) {
    vkDestroyQueryPool(device_.handle(), s.queries, nullptr);
    vkDestroyFence(device_.handle(), s.fence, nullptr);
    vkDestroyCommandPool(device_.handle(), s.pool, nullptr);
  }
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
  }
  makeTimers(graph().passes.size());
}

/// Everything that a frame writes times into, as many as the graph has passes: nothing is allocated later. No frame may
/// be in flight. When it throws, what was there stays.
void Executor::makeTimers(size_t passes) {
  const bool timed = device_.capabilities().timestampPeriod > 0;
  FrameTimes empty;
  empty.cpu.resize(passes);
  if (timed) empty.gpu.resize(passes);
  std::vector<uint64_t> ticks(passes + 2);
  std::vector<FrameTimes> times(kTimesKept, empty);
  std::array<VkQueryPool, kSlots> pools{};
  try {
    for (VkQueryPool& pool : pools) {
      if (!timed) continue;
      VkQueryPoolCreateInfo queries{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
      queries.queryType = VK_QUERY_TYPE_TIMESTAMP;
      queries.queryCount = static_cast<uint32_t>(passes + 2);
      gpu::check(vkCreateQueryPool(device_.handle(), &queries, nullptr, &pool), "vkCreateQueryPool");
    }
  } catch (...) {
    for (VkQueryPool pool : pools) vkDestroyQueryPool(device_.handle(), pool, nullptr);
    throw;
  }
  ticks_ = std::move(ticks);
  times_ = std::move(times);
  firstTime_ = timesHeld_ = 0;
  for (uint32_t s = 0; s < kSlots; ++s) {
    slots_[s].times = empty;
    vkDestroyQueryPool(device_.handle(), std::exchange(slots_[s].queries, pools[s]), nullptr);
  }
}

void Executor::swap(graph::CompiledGraph graph) {
  if (runtime_->update(graph)) {
    source_ = std::move(graph);
    return;
  }
  restart(std::move(graph));
}

void Executor::restart(graph::CompiledGraph graph) {
  notFromSink("restart");
  const bool resized = graph.width != source_.width || graph.height != source_.height;
  std::set<std::string> before = std::exchange(shaderFiles_, {});
  try {
    auto next = std::make_unique<GraphRuntime>(services_, scene_, graph, options_, runtime_.get());
    finish();            // frames in flight use what is about to go,
    device_.waitIdle();  // and so may commands of those who asked where something lies
    captureLanesTo({}, {});
    const auto name = [](const graph::CompiledPass& pass) { return pass.name; };
    const bool samePasses = std::ranges::equal(next->graph().passes, runtime_->graph().passes, {}, name, name);
    if (!samePasses) makeTimers(next->graph().passes.size());  // times are by pass
    runtime_ = std::move(next);
  } catch (...) {
    shaderFiles_.merge(before);  // the graph that goes on has its own
    throw;
  }
  source_ = std::move(graph);
  if (resized) resetHistory();
}

void Executor::collect(Slot& slot) {
  if (!slot.busy) return;
  gpu::check(vkWaitForFences(device_.handle(), 1, &slot.fence, VK_TRUE, std::numeric_limits<uint64_t>::max()),
             "vkWaitForFences");
  gpu::check(vkResetFences(device_.handle(), 1, &slot.fence), "vkResetFences");
  slot.busy = false;
  if (slot.queries != VK_NULL_HANDLE) {
    // The fence says that they are there: nothing waits here.
    gpu::check(
        vkGetQueryPoolResults(device_.handle(), slot.queries, 0, static_cast<uint32_t>(ticks_.size()),
                              ticks_.size() * 8, ticks_.data(), 8, VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
        "vkGetQueryPoolResults");
    const double period = device_.capabilities().timestampPeriod * 1e-6;
    slot.times.gpuScene = static_cast<double>(ticks_[1] - ticks_[0]) * period;
    for (size_t i = 0; i < slot.times.gpu.size(); ++i)
      slot.times.gpu[i] = static_cast<double>(ticks_[i + 2] - ticks_[i + 1]) * period;
    slot.times.gpuFrame = static_cast<double>(ticks_.back() - ticks_.front()) * period;
  }
  times_[(firstTime_ + timesHeld_) % kTimesKept] = slot.times;
  if (timesHeld_ < kTimesKept)
    ++timesHeld_;
  else
    firstTime_ = (firstTime_ + 1) % kTimesKept;
  if (options_.countRays) {
    scene_.rayCounter().invalidate();
    uint32_t count = 0;
    std::memcpy(&count, scene_.rayCounter().mapped(), sizeof count);
    rays_ = count;
  }
  deliver(slot);  // last, as it may throw
}

void Executor::record(Slot& slot, uint32_t slotIndex, const FrameInput& input, bool capture) {
  gpu::check(vkResetCommandPool(device_.handle(), slot.pool, 0), "vkResetCommandPool");
  VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  gpu::check(vkBeginCommandBuffer(slot.commands, &begin), "vkBeginCommandBuffer");
  const uint32_t parity = scene_.parity();
  runtime_->record(slot.commands, input, slotIndex, {slot.queries, slot.times.cpu});
  slot.captured = capture && !captured_.empty() ? scene_.active() : 0;
  if (slot.captured > 0) recordCaptures(slot, parity);
  if (options_.countRays)  // the host reads the count
    gpu::memoryBarrier(slot.commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                       VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
}

void Executor::frame(const FrameInput& input, bool capture) {
  notFromSink("frame");
  const auto slotIndex = static_cast<uint32_t>(scene_.frames() % kSlots);
  Slot& slot = slots_[slotIndex];
  collect(slot);  // waits for the frame before last: no work of this one's
  if (options_.countRays) {
    finish();
    std::memset(scene_.rayCounter().mapped(), 0, sizeof(uint32_t));
    scene_.rayCounter().flush();
  }
  const Clock::time_point start = Clock::now();
  record(slot, slotIndex, input, capture);
  VkCommandBufferSubmitInfo commands{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
  commands.commandBuffer = slot.commands;
  VkSubmitInfo2 submit{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
  submit.commandBufferInfoCount = 1;
  submit.pCommandBufferInfos = &commands;
  try {
    gpu::check(vkEndCommandBuffer(slot.commands), "vkEndCommandBuffer");
    gpu::check(vkQueueSubmit2(device_.queue(), 1, &submit, slot.fence), "vkQueueSubmit2");
  } catch (...) {
    scene_.forget();  // what this frame was to leave behind is not there
    throw;
  }
  slot.busy = true;
  slot.times.cpuFrame = millisecondsSince(start);
}

void Executor::finish() {
  for (uint64_t i = 0; i < kSlots; ++i) collect(slots_[(scene_.frames() + i) % kSlots]);  // oldest first
}

std::vector<FrameTimes> Executor::takeTimes() {
  std::vector<FrameTimes> result;
  for (size_t i = 0; i < timesHeld_; ++i) result.push_back(times_[(firstTime_ + i) % kTimesKept]);
  firstTime_ = timesHeld_ = 0;
  return result;
}

uint64_t Executor::savedBytes() const {
  // Alignment can cost a little more than sharing saves.
  const uint64_t separate = scene_.lanes() * graph().separateBytes(), taken = transientBytes();
  return separate > taken ? separate - taken : 0;
}

}  // namespace weir::execute
