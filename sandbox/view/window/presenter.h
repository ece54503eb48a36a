// A frame of the window: the canvas that the picture is composed on, ImGui over it, both into the swapchain.
#pragma once

#include "view/window/swapchain.h"

#include <weir/gpu/memory.h>
#include <weir/image/image.h>

#include <array>
#include <functional>
#include <optional>

struct ImDrawData;

namespace weir::view {

class Presenter {
 public:
  static constexpr uint32_t kSlots = 2;  ///< frames of the window in flight

  /// ImGui's context must be there, and outlive this. Throws RuntimeError.
  Presenter(const gpu::Device& device, const Window& window, Pacing pacing);
  ~Presenter();
  Presenter(const Presenter&) = delete;
  Presenter& operator=(const Presenter&) = delete;

  /// Records what is shown below ImGui: canvas is an RGBA8 storage image of the framebuffer's size in
  /// VK_IMAGE_LAYOUT_GENERAL with undefined content. Everything earlier in the queue is waited for, and everything
  /// later waits for it. What was recorded with the same slot before is done.
  using Compose = std::function<void(VkCommandBuffer commands, uint32_t slot, const gpu::Image& canvas)>;
  /// Composes, draws and presents. False when there was nothing to show on: a minimised window.
  bool show(const Compose& compose, ImDrawData* ui);

  /// The next frame that is shown comes back as a picture, display-referred RGB; see takeShot().
  void requestShot() { shotWanted_ = true; }
  std::optional<image::Picture> takeShot();

  Swapchain& swapchain() { return swapchain_; }
  /// After fonts were loaded anew.
  void renewFonts();

 private:
  struct Slot {
    VkCommandPool pool = VK_NULL_HANDLE;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    VkFence done = VK_NULL_HANDLE;
    VkSemaphore ready = VK_NULL_HANDLE;
  };
  void makeSlots();
  void makeUi();
  void makeFramebuffers();
  void freeFramebuffers();
  void record(Slot& slot, uint32_t slotIndex, uint32_t image, const Compose& compose, ImDrawData* ui);
  void drawUi(VkCommandBuffer commands, uint32_t image, ImDrawData* ui) const;
  void copyShot(VkCommandBuffer commands, uint32_t image);
  void destroy() noexcept;

  const gpu::Device& device_;
  Swapchain swapchain_;
  std::array<Slot, kSlots> slots_;
  uint32_t slot_ = 0;
  VkRenderPass renderPass_ = VK_NULL_HANDLE;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  VkFormat uiFormat_ = VK_FORMAT_UNDEFINED;
  bool uiMade_ = false;
  std::vector<VkFramebuffer> framebuffers_;
  uint64_t generation_ = 0;
  gpu::Image canvas_;
  gpu::Buffer shot_;
  glm::uvec2 shotSize_{0};
  VkFormat shotFormat_ = VK_FORMAT_UNDEFINED;
  bool shotWanted_ = false, shotTaken_ = false;
};

}  // namespace weir::view
