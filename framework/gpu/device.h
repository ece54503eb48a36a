// The Vulkan device: chosen by the user's word, created with what it has of what passes may need.
#pragma once

#include <weir/gpu/vulkan.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace weir::gpu {

struct DeviceOptions {
  std::string choice;  ///< "": the best there is; "cpu"; an index of `listDevices`; or part of a name, ignoring case
  bool validation =
      false;  ///< Khronos validation with synchronization checks; InputError where the layer isn't installed
  bool hideRayTracing = false;  ///< as if the device had none (tests of the raster path)
  bool hideRayQuery = false, hideRayPipeline = false;
  std::string cacheFolder;  ///< for the pipeline cache; empty: as `shader::Compiler`; "-": none
  /// What a window asks of the instance, with which the device gets VK_KHR_swapchain; empty: nothing is shown.
  /// InputError where the instance or the device lacks it.
  std::vector<std::string> windowExtensions;
};

/// A device that somebody else made and owns, and what it was made with. It must outlive whatever adopts it.
struct HostDevice {
  PFN_vkGetInstanceProcAddr loader = nullptr;  ///< where the host has Vulkan from; none: libvulkan.so.1
  VkInstance instance = VK_NULL_HANDLE;
  uint32_t apiVersion = 0;  ///< VkApplicationInfo::apiVersion of the instance
  std::vector<std::string> instanceExtensions;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  uint32_t queueFamily = 0;
  const VkPhysicalDeviceFeatures2* features = nullptr;  ///< as in VkDeviceCreateInfo::pNext; read at once
  std::vector<std::string> extensions;
  std::string pipelineCacheFolder;  ///< as cacheFolder in DeviceOptions
};

/// What a device offers beyond Weir's minimum.
struct Capabilities {
  bool accelerationStructure = false, rayPipeline = false, rayQuery = false;
  bool graphics = true;  ///< the queue can rasterise
  bool doubles = false;  ///< double precision in shaders
  uint32_t subgroupSize = 0;
  float timestampPeriod = 0.0f;  ///< nanoseconds a tick; 0: no timestamps
  uint32_t shaderGroupHandleSize = 0, shaderGroupHandleAlignment = 0, shaderGroupBaseAlignment = 0;
  uint32_t minScratchAlignment = 0;
  uint64_t maxStorageBufferRange = 0;
  uint32_t maxTextures = 0;  ///< sampled images in one bindless array
};

struct DeviceInfo {
  uint32_t index = 0;
  std::string name, driver;  ///< driver: name and version in words
  std::string kind;          ///< "discrete", "integrated", "virtual", "cpu", "other"
  uint32_t apiVersion = 0;
  std::vector<std::string> missing;                           ///< of Weir's minimum; empty: usable
  std::vector<std::string> missingForRays, missingForRaster;  ///< of what passes need that trace, or rasterise
  Capabilities capabilities;
};

/// Every Vulkan device of this machine, usable or not. Throws RuntimeError when there is no Vulkan at all.
std::vector<DeviceInfo> listDevices();

/// What a host's device was made with, seen as `listDevices` sees those of the machine. No device is needed for it,
/// only instance and physical device. Throws RuntimeError when there is no Vulkan, or not the host's.
DeviceInfo inspect(const HostDevice& host);

/// What a host should make its device with, so that it runs everything that its physical device can.
class HostNeeds {
 public:
  /// Looks at loader, instance and physical device alone. Throws as inspect() does.
  explicit HostNeeds(const HostDevice& host);
  ~HostNeeds();
  HostNeeds(const HostNeeds&) = delete;
  HostNeeds& operator=(const HostNeeds&) = delete;

  /// A chain for VkDeviceCreateInfo::pNext, in which the host may switch on more. Lives as long as this.
  VkPhysicalDeviceFeatures2* features();
  const std::vector<const char*>& extensions() const { return extensions_; }
  /// With what the physical device lacks of Weir's minimum, whatever is switched on.
  const DeviceInfo& info() const { return info_; }

 private:
  struct Chain;
  std::unique_ptr<Chain> chain_;
  std::vector<const char*> extensions_;
  DeviceInfo info_;
};

/// A message of the validation layers.
struct ValidationMessage {
  bool error = false;
  std::string id, text;
};

class Device {
 public:
  /// Throws InputError when no device fits `choice` (naming those there are), or the chosen one lacks something (naming
  /// what).
  explicit Device(const DeviceOptions& options);
  /// Works on a device of somebody else's; frees nothing of it. InputError naming what it lacks of Weir's minimum. Only
  /// submitAndWait and the destructor touch the queue.
  explicit Device(const HostDevice& host);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const DeviceInfo& info() const { return info_; }
  const Capabilities& capabilities() const { return info_.capabilities; }
  VkInstance instance() const { return instance_; }
  VkPhysicalDevice physical() const { return physical_; }
  VkDevice handle() const { return device_; }
  VkQueue queue() const { return queue_; }
  uint32_t queueFamily() const { return queueFamily_; }
  VmaAllocator allocator() const { return allocator_; }
  VkPipelineCache pipelineCache() const { return pipelineCache_; }

  /// Gives a Vulkan object its name in captures and messages. No-op where the instance lacks
  /// VK_EXT_debug_utils.
  void name(VkObjectType type, uint64_t handle, const std::string& name) const;
  void beginLabel(VkCommandBuffer commands, const char* name) const;
  void endLabel(VkCommandBuffer commands) const;

  /// Records with `record`, submits and waits: for loading and tests, never inside a frame.
  void submitAndWait(const std::function<void(VkCommandBuffer)>& record) const;
  void waitIdle() const;

  /// Warnings and errors of the validation layers so far (validation on). The caller decides; tests demand none.
  const std::vector<ValidationMessage>& validationMessages() const;
  void clearValidationMessages();

 private:
  struct Messages;
  struct Immediate;
  static VkBool32 VKAPI_PTR receive(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                    VkDebugUtilsMessageTypeFlagsEXT types,
                                    const VkDebugUtilsMessengerCallbackDataEXT* data, void* user);
  void create(const DeviceOptions& options);
  void createHandle(bool shows);
  void createServices(const std::string& cache);
  void createAllocator();
  void destroy() noexcept;
  bool owned_ = true;        ///< instance and device are to be destroyed here
  bool debugUtils_ = false;  ///< the instance has VK_EXT_debug_utils
  DeviceInfo info_;
  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  VkPhysicalDevice physical_ = VK_NULL_HANDLE;
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  uint32_t queueFamily_ = 0;
  VmaAllocator allocator_ = VK_NULL_HANDLE;
  VkPipelineCache pipelineCache_ = VK_NULL_HANDLE;
  VkCommandPool immediatePool_ = VK_NULL_HANDLE;
  std::unique_ptr<Messages> messages_;
  std::unique_ptr<Immediate> immediate_;  ///< submitAndWait's, one caller at a time
  std::string cacheFolder_;               ///< resolved; empty: the pipeline cache is not kept
};

/// Throws RuntimeError naming the call and the result when it isn't VK_SUCCESS.
void check(VkResult result, const char* call);
const char* resultName(VkResult result);

}  // namespace weir::gpu
