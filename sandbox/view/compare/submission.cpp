#include "view/compare/submission.h"

#include <algorithm>
#include <limits>

namespace weir::view {

Submission::Submission(const gpu::Device& device, const char* name) : device_(device) {
  try {
    VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    pool.queueFamilyIndex = device.queueFamily();
    gpu::check(vkCreateCommandPool(device.handle(), &pool, nullptr, &pool_), "vkCreateCommandPool");
    VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    allocate.commandPool = pool_;
    allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    allocate.commandBufferCount = 1;
    gpu::check(vkAllocateCommandBuffers(device.handle(), &allocate, &commands_), "vkAllocateCommandBuffers");
    const VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    gpu::check(vkCreateFence(device.handle(), &fence, nullptr, &fence_), "vkCreateFence");
  } catch (...) {
    destroy();
    throw;
  }
  device.name(VK_OBJECT_TYPE_COMMAND_BUFFER, reinterpret_cast<uint64_t>(commands_), name);
}

Submission::~Submission() {
  destroy();
}

void Submission::destroy() noexcept {
  // On a lost device the wait ends at once, and there is nothing more to do about it.
  if (busy_) vkWaitForFences(device_.handle(), 1, &fence_, VK_TRUE, std::numeric_limits<uint64_t>::max());
  vkDestroyFence(device_.handle(), fence_, nullptr);
  vkDestroyCommandPool(device_.handle(), pool_, nullptr);
}

VkCommandBuffer Submission::begin() {
  gpu::check(vkResetCommandPool(device_.handle(), pool_, 0), "vkResetCommandPool");
  VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  gpu::check(vkBeginCommandBuffer(commands_, &begin), "vkBeginCommandBuffer");
  return commands_;
}

void Submission::submit() {
  gpu::check(vkEndCommandBuffer(commands_), "vkEndCommandBuffer");
  gpu::check(vkResetFences(device_.handle(), 1, &fence_), "vkResetFences");
  VkCommandBufferSubmitInfo commands{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
  commands.commandBuffer = commands_;
  VkSubmitInfo2 submit{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
  submit.commandBufferInfoCount = 1;
  submit.pCommandBufferInfos = &commands;
  gpu::check(vkQueueSubmit2(device_.queue(), 1, &submit, fence_), "vkQueueSubmit2");
  busy_ = true;
}

bool Submission::done() {
  return done(std::chrono::nanoseconds(0));
}

bool Submission::done(std::chrono::nanoseconds atMost) {
  if (!busy_) return true;
  const auto wait = static_cast<uint64_t>(std::max<int64_t>(atMost.count(), 0));
  const VkResult result = vkWaitForFences(device_.handle(), 1, &fence_, VK_TRUE, wait);
  if (result == VK_TIMEOUT) return false;
  gpu::check(result, "vkWaitForFences");
  busy_ = false;
  return true;
}

}  // namespace weir::view
