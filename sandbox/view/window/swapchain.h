// The images that a window shows, made anew whenever they no longer fit it.
#pragma once

#include "view/window/window.h"

#include <weir/gpu/device.h>

#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

namespace weir::view {

/// Whether a picture waits for the display: V-sync; the newest one is shown when the display is ready; at once.
enum class Pacing : uint8_t { VSync, Newest, Immediate };

class Swapchain {
 public:
  /// Throws RuntimeError where the device can't show in this window.
  Swapchain(const gpu::Device& device, const Window& window, Pacing pacing);
  ~Swapchain();
  Swapchain(const Swapchain&) = delete;
  Swapchain& operator=(const Swapchain&) = delete;

  VkFormat format() const { return format_.format; }
  glm::uvec2 size() const { return {extent_.width, extent_.height}; }
  uint32_t count() const { return static_cast<uint32_t>(images_.size()); }
  VkImage image(uint32_t index) const { return images_[index]; }
  VkImageView view(uint32_t index) const { return views_[index]; }
  /// Signalled when the commands that draw image `index` are done, for present().
  VkSemaphore drawn(uint32_t index) const { return drawn_[index]; }
  bool readable() const { return readable_; }  ///< its images can be copied from
  /// Counts the times that the images were made: whoever holds something of theirs looks whether it changed.
  uint64_t generation() const { return generation_; }

  /// The next image to draw, ready when `ready` is signalled. None while the window has no size; the images are made
  /// anew first where the window's size or the pacing changed, and the surface where it was lost.
  std::optional<uint32_t> acquire(VkSemaphore ready);
  void present(uint32_t index);

  void setPacing(Pacing pacing);
  Pacing pacing() const { return pacing_; }
  /// What the device offers beside V-sync, which there always is.
  const std::vector<Pacing>& choices() const { return choices_; }

 private:
  bool make();
  void freeImages();
  void makeSurface();
  VkPresentModeKHR mode() const;

  const gpu::Device& device_;
  const Window& window_;
  Pacing pacing_;
  VkSurfaceKHR surface_ = VK_NULL_HANDLE;
  VkSwapchainKHR chain_ = VK_NULL_HANDLE;
  VkSurfaceFormatKHR format_{};
  VkExtent2D extent_{0, 0};
  std::vector<VkImage> images_;
  std::vector<VkImageView> views_;
  std::vector<VkSemaphore> drawn_;
  std::vector<Pacing> choices_;
  bool stale_ = true, lost_ = false, readable_ = false;
  uint64_t generation_ = 0;
};

}  // namespace weir::view
