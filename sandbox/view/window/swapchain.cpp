#include "view/window/swapchain.h"

#include <weir/core/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace weir::view {

Swapchain::Swapchain(const gpu::Device& device, const Window& window, Pacing pacing)
    : device_(device), window_(window), pacing_(pacing) {
  makeSurface();
}

Swapchain::~Swapchain() {
  device_.waitIdle();
  freeImages();
  vkDestroySwapchainKHR(device_.handle(), chain_, nullptr);
  vkDestroySurfaceKHR(device_.instance(), surface_, nullptr);
}

void Swapchain::makeSurface() {
  surface_ = window_.makeSurface(device_.instance());
  VkBool32 supported = VK_FALSE;
  gpu::check(vkGetPhysicalDeviceSurfaceSupportKHR(device_.physical(), device_.queueFamily(), surface_, &supported),
             "vkGetPhysicalDeviceSurfaceSupportKHR");
  if (supported == VK_FALSE) throw RuntimeError(device_.info().name + " cannot show pictures in this window");

  uint32_t count = 0;
  gpu::check(vkGetPhysicalDeviceSurfaceFormatsKHR(device_.physical(), surface_, &count, nullptr),
             "vkGetPhysicalDeviceSurfaceFormatsKHR");
  std::vector<VkSurfaceFormatKHR> formats(count);
  gpu::check(vkGetPhysicalDeviceSurfaceFormatsKHR(device_.physical(), surface_, &count, formats.data()),
             "vkGetPhysicalDeviceSurfaceFormatsKHR");
  if (formats.empty()) throw RuntimeError(device_.info().name + " has no format for this window");
  // What is copied there is encoded for displays already: an sRGB format would encode it again.
  const auto found = std::ranges::find_if(formats, [](const VkSurfaceFormatKHR& f) {
    return f.format == VK_FORMAT_B8G8R8A8_UNORM || f.format == VK_FORMAT_R8G8B8A8_UNORM;
  });
  if (found == formats.end()) throw RuntimeError(device_.info().name + " offers this window no 8-bit UNORM format");
  format_ = *found;

  uint32_t modeCount = 0;
  gpu::check(vkGetPhysicalDeviceSurfacePresentModesKHR(device_.physical(), surface_, &modeCount, nullptr),
             "vkGetPhysicalDeviceSurfacePresentModesKHR");
  std::vector<VkPresentModeKHR> modes(modeCount);
  gpu::check(vkGetPhysicalDeviceSurfacePresentModesKHR(device_.physical(), surface_, &modeCount, modes.data()),
             "vkGetPhysicalDeviceSurfacePresentModesKHR");
  choices_ = {Pacing::VSync};
  if (std::ranges::count(modes, VK_PRESENT_MODE_MAILBOX_KHR) > 0) choices_.push_back(Pacing::Newest);
  if (std::ranges::count(modes, VK_PRESENT_MODE_IMMEDIATE_KHR) > 0) choices_.push_back(Pacing::Immediate);
}

VkPresentModeKHR Swapchain::mode() const {
  if (std::ranges::count(choices_, pacing_) == 0) return VK_PRESENT_MODE_FIFO_KHR;
  switch (pacing_) {
    case Pacing::Newest:
      return VK_PRESENT_MODE_MAILBOX_KHR;
    case Pacing::Immediate:
      return VK_PRESENT_MODE_IMMEDIATE_KHR;
    default:
      return VK_PRESENT_MODE_FIFO_KHR;
  }
}

void Swapchain::setPacing(Pacing pacing) {
  stale_ = stale_ || pacing != pacing_;
  pacing_ = pacing;
}

void Swapchain::freeImages() {
  for (VkImageView view : views_) vkDestroyImageView(device_.handle(), view, nullptr);
  for (VkSemaphore semaphore : drawn_) vkDestroySemaphore(device_.handle(), semaphore, nullptr);
  views_.clear();
  drawn_.clear();
  images_.clear();
}

/// False while the window has no size.
bool Swapchain::make() {
  device_.waitIdle();
  if (lost_) {
    freeImages();
    vkDestroySwapchainKHR(device_.handle(), chain_, nullptr);
    chain_ = VK_NULL_HANDLE;
    vkDestroySurfaceKHR(device_.instance(), surface_, nullptr);
    surface_ = VK_NULL_HANDLE;
    makeSurface();
    lost_ = false;
  }
  VkSurfaceCapabilitiesKHR can{};
  const VkResult asked = vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device_.physical(), surface_, &can);
  if (asked == VK_ERROR_SURFACE_LOST_KHR) {
    lost_ = true;
    return false;
  }
  gpu::check(asked, "vkGetPhysicalDeviceSurfaceCapabilitiesKHR");
  extent_ = can.currentExtent;
  if (extent_.width == std::numeric_limits<uint32_t>::max()) {
    const glm::ivec2 size = window_.framebufferSize();
    extent_.width = std::clamp(static_cast<uint32_t>(size.x), can.minImageExtent.width, can.maxImageExtent.width);
    extent_.height = std::clamp(static_cast<uint32_t>(size.y), can.minImageExtent.height, can.maxImageExtent.height);
  }
  if (extent_.width == 0 || extent_.height == 0) return false;

  VkSwapchainCreateInfoKHR info{VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR};
  info.surface = surface_;
  info.minImageCount =
      can.maxImageCount > 0 ? std::min(can.minImageCount + 1, can.maxImageCount) : can.minImageCount + 1;
  info.imageFormat = format_.format;
  info.imageColorSpace = format_.colorSpace;
  info.imageExtent = extent_;
  info.imageArrayLayers = 1;
  info.imageUsage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  if ((can.supportedUsageFlags & info.imageUsage) != info.imageUsage)
    throw RuntimeError(device_.info().name + " can't copy pictures into this window");
  readable_ = (can.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_SRC_BIT) != 0;
  if (readable_) info.imageUsage |= VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
  info.preTransform = can.currentTransform;
  info.compositeAlpha = (can.supportedCompositeAlpha & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR) != 0
                            ? VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                            : VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR;
  info.presentMode = mode();
  info.clipped = VK_TRUE;
  info.oldSwapchain = chain_;
  VkSwapchainKHR made = VK_NULL_HANDLE;
  const VkResult result = vkCreateSwapchainKHR(device_.handle(), &info, nullptr, &made);
  freeImages();
  vkDestroySwapchainKHR(device_.handle(), chain_, nullptr);
  chain_ = made;
  if (result == VK_ERROR_SURFACE_LOST_KHR) {
    lost_ = true;
    return false;
  }
  gpu::check(result, "vkCreateSwapchainKHR");

  uint32_t count = 0;
  gpu::check(vkGetSwapchainImagesKHR(device_.handle(), chain_, &count, nullptr), "vkGetSwapchainImagesKHR");
  images_.resize(count);
  gpu::check(vkGetSwapchainImagesKHR(device_.handle(), chain_, &count, images_.data()), "vkGetSwapchainImagesKHR");
  for (uint32_t i = 0; i < count; ++i) {
    VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
    view.image = images_[i];
    view.viewType = VK_IMAGE_VIEW_TYPE_2D;
    view.format = format_.format;
    view.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    VkImageView handle = VK_NULL_HANDLE;
    gpu::check(vkCreateImageView(device_.handle(), &view, nullptr, &handle), "vkCreateImageView");
    views_.push_back(handle);
    const VkSemaphoreCreateInfo semaphore{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, nullptr, 0};
    VkSemaphore signal = VK_NULL_HANDLE;
    gpu::check(vkCreateSemaphore(device_.handle(), &semaphore, nullptr, &signal), "vkCreateSemaphore");
    drawn_.push_back(signal);
  }
  stale_ = false;
  ++generation_;
  return true;
}

std::optional<uint32_t> Swapchain::acquire(VkSemaphore ready) {
  // A window that changes its size while the images are made is followed in the next frame.
  for (int attempt = 0; attempt < 3; ++attempt) {
    if ((stale_ || lost_ || chain_ == VK_NULL_HANDLE) && !make()) return std::nullopt;
    uint32_t index = 0;
    const VkResult result = vkAcquireNextImageKHR(device_.handle(), chain_, std::numeric_limits<uint64_t>::max(), ready,
                                                  VK_NULL_HANDLE, &index);
    if (result == VK_SUCCESS || result == VK_SUBOPTIMAL_KHR) {
      stale_ = result == VK_SUBOPTIMAL_KHR;
      return index;
    }
    if (result == VK_ERROR_SURFACE_LOST_KHR)
      lost_ = true;
    else if (result == VK_ERROR_OUT_OF_DATE_KHR)
      stale_ = true;
    else
      gpu::check(result, "vkAcquireNextImageKHR");
  }
  return std::nullopt;
}

void Swapchain::present(uint32_t index) {
  VkPresentInfoKHR info{VK_STRUCTURE_TYPE_PRESENT_INFO_KHR};
  info.waitSemaphoreCount = 1;
  info.pWaitSemaphores = &drawn_[index];
  info.swapchainCount = 1;
  info.pSwapchains = &chain_;
  info.pImageIndices = &index;
  const VkResult result = vkQueuePresentKHR(device_.queue(), &info);
  if (result == VK_ERROR_SURFACE_LOST_KHR)
    lost_ = true;
  else if (result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR)
    stale_ = true;
  else
    gpu::check(result, "vkQueuePresentKHR");
}

}  // namespace weir::view
