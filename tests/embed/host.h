// A host for tests: an instance with validation, a device with the features that a test wants, images with known
// content. It watches what Weir calls.
#pragma once

#include <weir/embed/embed.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace weir::test {

/// Counts what goes through the vkGetInstanceProcAddr that the host hands over.
struct Watched {
  std::atomic<int> submits{0}, waits{0}, labels{0}, names{0};
};
Watched& watched();

struct HostOptions {
  bool debugUtils = true;  ///< false: an instance without extensions and layers
  /// Changes features and extensions before the device is made.
  std::function<void(VkPhysicalDeviceFeatures2&, std::vector<const char*>&)> adjust;
};

struct HostImage {
  VkImage image = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  VkImageView view = VK_NULL_HANDLE;
  VkFormat format = VK_FORMAT_UNDEFINED;
  uint32_t width = 0, height = 0;
  VkImageUsageFlags usage = 0;
};

struct HostBuffer {
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  VkDeviceSize bytes = 0;
  float* mapped = nullptr;
};

inline constexpr VkImageUsageFlags kAllUsage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT |
                                               VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;

/// Fails the test at its end when the validation layers said anything, the destruction of the device included.
class Host {
 public:
  explicit Host(const HostOptions& options = {});
  ~Host();
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;

  Weir* weir() { return weir_; }
  const WeirHost& info() const { return info_; }
  WeirContext* context();  ///< made at the first call, gone with the host
  std::string message() const { return weirMessage(weir_); }
  std::vector<std::string> lines() const;

  HostImage image(VkFormat format, uint32_t width, uint32_t height, VkImageUsageFlags usage = kAllUsage);
  HostBuffer buffer(VkDeviceSize bytes);
  /// Frees everything that image() and buffer() made.
  VkQueryPool queries(uint32_t count);

  /// Records with `record`, submits, and waits if `wait`. Command buffers stay until the host goes.
  void run(const std::function<void(VkCommandBuffer)>& record, bool wait = true);
  void idle();

 private:
  void makeInstance(bool debugUtils);
  void makeDevice(const HostOptions& options);
  VkDeviceMemory allocate(const VkMemoryRequirements& asked, VkMemoryPropertyFlags wanted);

  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  std::vector<std::string> messages_;
  std::vector<const char*> instanceExtensions_, deviceExtensions_;
  std::vector<HostImage> images_;
  std::vector<HostBuffer> buffers_;
  std::vector<VkQueryPool> queries_;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  WeirHost info_{};
  Weir* weir_ = nullptr;
  WeirNeeds* needs_ = nullptr;
  WeirContext* context_ = nullptr;
};

/// A use of an image for barriers and bindings.
inline WeirAccess use(VkPipelineStageFlags2 stages, VkAccessFlags2 access, VkImageLayout layout) {
  return {stages, access, layout};
}
void barrier(VkCommandBuffer commands, const HostImage& image, const WeirAccess& from, const WeirAccess& to);

}  // namespace weir::test
