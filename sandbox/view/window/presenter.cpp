#include "view/window/presenter.h"

#include <weir/core/error.h>
#include <weir/gpu/barrier.h>

// Declares Vulkan's functions as its own header does: with our names for the entry points, which the types don't mind.
#include <backends/imgui_impl_vulkan.h>
#include <imgui.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace weir::view {
namespace {

constexpr VkImageSubresourceRange kColor{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};

void imageBarrier(VkCommandBuffer commands, VkImage image, VkImageLayout from, VkImageLayout to,
                  VkPipelineStageFlags2 before, VkAccessFlags2 beforeAccess, VkPipelineStageFlags2 after,
                  VkAccessFlags2 afterAccess) {
  VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
  barrier.srcStageMask = before;
  barrier.srcAccessMask = beforeAccess;
  barrier.dstStageMask = after;
  barrier.dstAccessMask = afterAccess;
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image;
  barrier.subresourceRange = kColor;
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.imageMemoryBarrierCount = 1;
  info.pImageMemoryBarriers = &barrier;
  vkCmdPipelineBarrier2(commands, &info);
}

}  // namespace

Presenter::Presenter(const gpu::Device& device, const Window& window, Pacing pacing)
    : device_(device), swapchain_(device, window, pacing) {
  try {
    makeSlots();
    makeUi();
  } catch (...) {
    destroy();
    throw;
  }
}

Presenter::~Presenter() {
  destroy();
}

void Presenter::destroy() noexcept {
  vkDeviceWaitIdle(device_.handle());
  if (uiMade_) ImGui_ImplVulkan_Shutdown();
  freeFramebuffers();
  vkDestroyRenderPass(device_.handle(), renderPass_, nullptr);
  vkDestroyDescriptorPool(device_.handle(), pool_, nullptr);
  for (const Slot& slot : slots_) {
    vkDestroyCommandPool(device_.handle(), slot.pool, nullptr);
    vkDestroyFence(device_.handle(), slot.done, nullptr);
    vkDestroySemaphore(device_.handle(), slot.ready, nullptr);
  }
}

void Presenter::makeSlots() {
  for (Slot& slot : slots_) {
    VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    pool.queueFamilyIndex = device_.queueFamily();
    gpu::check(vkCreateCommandPool(device_.handle(), &pool, nullptr, &slot.pool), "vkCreateCommandPool");
    VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    allocate.commandPool = slot.pool;
    allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    allocate.commandBufferCount = 1;
    gpu::check(vkAllocateCommandBuffers(device_.handle(), &allocate, &slot.commands), "vkAllocateCommandBuffers");
    VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    fence.flags = VK_FENCE_CREATE_SIGNALED_BIT;
    gpu::check(vkCreateFence(device_.handle(), &fence, nullptr, &slot.done), "vkCreateFence");
    const VkSemaphoreCreateInfo semaphore{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, nullptr, 0};
    gpu::check(vkCreateSemaphore(device_.handle(), &semaphore, nullptr, &slot.ready), "vkCreateSemaphore");
  }
}

/// The render pass that ImGui draws in, and ImGui's renderer for it.
void Presenter::makeUi() {
  uiFormat_ = swapchain_.format();
  VkAttachmentDescription color{};
  color.format = uiFormat_;
  color.samples = VK_SAMPLE_COUNT_1_BIT;
  color.loadOp = VK_ATTACHMENT_LOAD_OP_LOAD;
  color.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  color.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
  color.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
  color.initialLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  color.finalLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  const VkAttachmentReference reference{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  VkSubpassDescription subpass{};
  subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
  subpass.colorAttachmentCount = 1;
  subpass.pColorAttachments = &reference;
  VkRenderPassCreateInfo pass{VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO};
  pass.attachmentCount = 1;
  pass.pAttachments = &color;
  pass.subpassCount = 1;
  pass.pSubpasses = &subpass;
  gpu::check(vkCreateRenderPass(device_.handle(), &pass, nullptr, &renderPass_), "vkCreateRenderPass");

  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 8};
  VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  pool.flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT;
  pool.maxSets = 8;
  pool.poolSizeCount = 1;
  pool.pPoolSizes = &size;
  gpu::check(vkCreateDescriptorPool(device_.handle(), &pool, nullptr, &pool_), "vkCreateDescriptorPool");

  ImGui_ImplVulkan_InitInfo info{};
  info.Instance = device_.instance();
  info.PhysicalDevice = device_.physical();
  info.Device = device_.handle();
  info.QueueFamily = device_.queueFamily();
  info.Queue = device_.queue();
  info.PipelineCache = device_.pipelineCache();
  info.DescriptorPool = pool_;
  info.MinImageCount = kSlots;
  info.ImageCount = kSlots;  // vertex buffers of its own for so many frames
  info.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
  // Called from C++ that may throw; a lost device ends the program with its name.
  info.CheckVkResultFn = [](VkResult result) {
    if (result < VK_SUCCESS) gpu::check(result, "drawing the window's panels");
  };
  if (!ImGui_ImplVulkan_Init(&info, renderPass_))
    throw RuntimeError("the window's panels can't be drawn on this device");
  uiMade_ = true;
  renewFonts();
}

void Presenter::renewFonts() {
  device_.waitIdle();
  ImGui_ImplVulkan_DestroyFontUploadObjects();
  device_.submitAndWait([](VkCommandBuffer commands) { ImGui_ImplVulkan_CreateFontsTexture(commands); });
  ImGui_ImplVulkan_DestroyFontUploadObjects();
}

void Presenter::freeFramebuffers() {
  for (VkFramebuffer framebuffer : framebuffers_) vkDestroyFramebuffer(device_.handle(), framebuffer, nullptr);
  framebuffers_.clear();
}

/// For the swapchain's present images; the device is idle, as it is whenever those are made anew.
void Presenter::makeFramebuffers() {
  device_.waitIdle();
  freeFramebuffers();
  const glm::uvec2 size = swapchain_.size();
  for (uint32_t i = 0; i < swapchain_.count(); ++i) {
    VkImageView view = swapchain_.view(i);
    VkFramebufferCreateInfo info{VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO};
    info.renderPass = renderPass_;
    info.attachmentCount = 1;
    info.pAttachments = &view;
    info.width = size.x;
    info.height = size.y;
    info.layers = 1;
    VkFramebuffer framebuffer = VK_NULL_HANDLE;
    gpu::check(vkCreateFramebuffer(device_.handle(), &info, nullptr, &framebuffer), "vkCreateFramebuffer");
    framebuffers_.push_back(framebuffer);
  }
  gpu::ImageDesc canvas;
  canvas.width = size.x;
  canvas.height = size.y;
  canvas.usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  canvas_ = gpu::Image(device_, canvas, "canvas");
  generation_ = swapchain_.generation();
}

bool Presenter::show(const Compose& compose, ImDrawData* ui) {
  Slot& slot = slots_[slot_];
  gpu::check(vkWaitForFences(device_.handle(), 1, &slot.done, VK_TRUE, std::numeric_limits<uint64_t>::max()),
             "vkWaitForFences");
  const std::optional<uint32_t> image = swapchain_.acquire(slot.ready);
  if (!image) return false;
  if (generation_ != swapchain_.generation()) makeFramebuffers();
  gpu::check(vkResetFences(device_.handle(), 1, &slot.done), "vkResetFences");
  record(slot, slot_, *image, compose, ui);

  VkSemaphoreSubmitInfo wait{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO};
  wait.semaphore = slot.ready;
  wait.stageMask = VK_PIPELINE_STAGE_2_TRANSFER_BIT;  // the first that touches the image
  VkSemaphoreSubmitInfo signal{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO};
  signal.semaphore = swapchain_.drawn(*image);
  signal.stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  VkCommandBufferSubmitInfo commands{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
  commands.commandBuffer = slot.commands;
  VkSubmitInfo2 submit{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
  submit.waitSemaphoreInfoCount = 1;
  submit.pWaitSemaphoreInfos = &wait;
  submit.commandBufferInfoCount = 1;
  submit.pCommandBufferInfos = &commands;
  submit.signalSemaphoreInfoCount = 1;
  submit.pSignalSemaphoreInfos = &signal;
  gpu::check(vkQueueSubmit2(device_.queue(), 1, &submit, slot.done), "vkQueueSubmit2");
  swapchain_.present(*image);
  slot_ = (slot_ + 1) % kSlots;
  return true;
}

void Presenter::record(Slot& slot, uint32_t slotIndex, uint32_t image, const Compose& compose, ImDrawData* ui) {
  gpu::check(vkResetCommandPool(device_.handle(), slot.pool, 0), "vkResetCommandPool");
  VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  gpu::check(vkBeginCommandBuffer(slot.commands, &begin), "vkBeginCommandBuffer");

  // The last frame of the window may still copy from the canvas.
  gpu::fullBarrier(slot.commands);
  imageBarrier(slot.commands, canvas_.handle(), VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL,
               VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, 0, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
               VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT);
  compose(slot.commands, slotIndex, canvas_);
  gpu::fullBarrier(slot.commands);

  VkImage target = swapchain_.image(image);
  imageBarrier(slot.commands, target, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
               VK_PIPELINE_STAGE_2_TRANSFER_BIT, 0, VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT);
  const glm::ivec2 size(swapchain_.size());
  VkImageBlit blit{};
  blit.srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  blit.srcOffsets[1] = {size.x, size.y, 1};
  blit.dstSubresource = blit.srcSubresource;
  blit.dstOffsets[1] = blit.srcOffsets[1];
  // A blit puts the channels in the swapchain's order.
  vkCmdBlitImage(slot.commands, canvas_.handle(), VK_IMAGE_LAYOUT_GENERAL, target, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                 1, &blit, VK_FILTER_NEAREST);
  imageBarrier(slot.commands, target, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
               VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
               VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
               VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT);
  drawUi(slot.commands, image, ui);
  if (shotWanted_ && swapchain_.readable()) {
    copyShot(slot.commands, image);
  } else {
    imageBarrier(slot.commands, target, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR,
                 VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT, VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT,
                 VK_PIPELINE_STAGE_2_BOTTOM_OF_PIPE_BIT, 0);
  }
  gpu::check(vkEndCommandBuffer(slot.commands), "vkEndCommandBuffer");
}

void Presenter::drawUi(VkCommandBuffer commands, uint32_t image, ImDrawData* ui) const {
  const glm::uvec2 size = swapchain_.size();
  VkRenderPassBeginInfo pass{VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO};
  pass.renderPass = renderPass_;
  pass.framebuffer = framebuffers_[image];
  pass.renderArea.extent = {size.x, size.y};
  vkCmdBeginRenderPass(commands, &pass, VK_SUBPASS_CONTENTS_INLINE);
  if (ui != nullptr) ImGui_ImplVulkan_RenderDrawData(ui, commands);
  vkCmdEndRenderPass(commands);
}

void Presenter::copyShot(VkCommandBuffer commands, uint32_t image) {
  shotWanted_ = false;
  shotTaken_ = true;
  shotSize_ = swapchain_.size();
  shotFormat_ = swapchain_.format();
  shot_ = gpu::Buffer(device_, uint64_t{4} * shotSize_.x * shotSize_.y, VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                      gpu::Residency::Readback, "screenshot");
  VkImage target = swapchain_.image(image);
  imageBarrier(commands, target, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
               VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT, VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT,
               VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT);
  VkBufferImageCopy copy{};
  copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  copy.imageExtent = {shotSize_.x, shotSize_.y, 1};
  vkCmdCopyImageToBuffer(commands, target, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, shot_.handle(), 1, &copy);
  imageBarrier(commands, target, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR,
               VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT, VK_PIPELINE_STAGE_2_BOTTOM_OF_PIPE_BIT,
               0);
  gpu::memoryBarrier(commands, VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                     VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
}

std::optional<image::Picture> Presenter::takeShot() {
  if (!shotTaken_) return std::nullopt;
  shotTaken_ = false;
  device_.waitIdle();
  shot_.invalidate();
  image::Picture picture;
  picture.width = shotSize_.x;
  picture.height = shotSize_.y;
  const size_t pixels = size_t{shotSize_.x} * shotSize_.y;
  picture.rgba.assign(pixels * 4, 1.0f);
  const bool blueFirst = shotFormat_ == VK_FORMAT_B8G8R8A8_UNORM;
  for (size_t i = 0; i < pixels; ++i) {
    for (size_t c = 0; c < 3; ++c) {
      const std::byte value = shot_.mapped()[i * 4 + (blueFirst ? 2 - c : c)];
      picture.rgba[i * 4 + c] = static_cast<float>(std::to_integer<uint32_t>(value)) / 255.0f;
    }
  }
  shot_ = {};
  return picture;
}

}  // namespace weir::view
