// Creating and destroying the device, and the small services around it.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <weir/core/cache_folder.h>
#include <weir/core/error.h>
#include <weir/gpu/device.h>
#include <weir/gpu/probe.h>
#include <weir/gpu/vma.h>

#include <algorithm>
#include <mutex>

namespace weir::gpu {

struct Device::Messages {
  std::mutex mutex;
  std::vector<ValidationMessage> all;
  std::vector<ValidationMessage> handedOut;  ///< what the caller may look at while a driver thread adds to `all`
};

struct Device::Immediate {
  std::mutex mutex;
  VkFence fence = VK_NULL_HANDLE;
};

VkBool32 VKAPI_PTR Device::receive(VkDebugUtilsMessageSeverityFlagBitsEXT severity, VkDebugUtilsMessageTypeFlagsEXT,
                                   const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  ValidationMessage message{.error = severity >= VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
                            .id = data->pMessageIdName ? data->pMessageIdName : "",
                            .text = data->pMessage ? data->pMessage : ""};
  Messages& messages = *static_cast<Messages*>(user);
  const std::lock_guard lock(messages.mutex);
  // A fault inside a frame loop would otherwise fill the memory with copies of itself.
  static constexpr size_t kMost = 1000;
  if (messages.all.size() < kMost) messages.all.push_back(std::move(message));
  return VK_FALSE;
}

std::vector<DeviceInfo> listDevices() {
  const VkInstance instance = createInstance(false, nullptr);
  std::vector<DeviceInfo> infos;
  for (Probe& probe : probeDevices(instance, {})) infos.push_back(std::move(probe.info));
  vkDestroyInstance(instance, nullptr);
  return infos;
}

Device::Device(const DeviceOptions& options)
    : messages_(std::make_unique<Messages>()), immediate_(std::make_unique<Immediate>()) {
  try {
    create(options);
  } catch (...) {
    destroy();
    throw;
  }
}

Device::Device(const HostDevice& host)
    : owned_(false), messages_(std::make_unique<Messages>()), immediate_(std::make_unique<Immediate>()) {
  if (host.instance == VK_NULL_HANDLE || host.physical == VK_NULL_HANDLE || host.device == VK_NULL_HANDLE ||
      host.queue == VK_NULL_HANDLE)
    throw InputError("the host's instance, physical device, device and queue must all be given");
  info_ = inspect(host);
  if (!info_.missing.empty())
    throw InputError(
        fmt::format("the host's device ({}) cannot run Weir: it lacks {}", info_.name, fmt::join(info_.missing, ", ")));
  instance_ = host.instance;
  physical_ = host.physical;
  device_ = host.device;
  queue_ = host.queue;
  queueFamily_ = host.queueFamily;
  debugUtils_ = hasDebugUtils() &&
                std::ranges::count(host.instanceExtensions, std::string(VK_EXT_DEBUG_UTILS_EXTENSION_NAME)) > 0;
  try {
    createServices(host.pipelineCacheFolder);
  } catch (...) {
    destroy();
    throw;
  }
}

Device::~Device() {
  destroy();
}

void Device::create(const DeviceOptions& options) {
  // Only what the validation layer finds: the loader's own remarks (a driver that failed to load, say) are GENERAL.
  const VkDebugUtilsMessengerCreateInfoEXT messenger{
      .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
      .messageSeverity =
          VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
      .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
      .pfnUserCallback = &Device::receive,
      .pUserData = messages_.get()};
  instance_ = createInstance(options.validation, &messenger, options.windowExtensions);
  debugUtils_ = hasDebugUtils();
  if (options.validation && debugUtils_) {
    check(vkCreateDebugUtilsMessengerEXT(instance_, &messenger, nullptr, &messenger_),
          "vkCreateDebugUtilsMessengerEXT");
  }
  const std::vector<Probe> probes = probeDevices(instance_, options);
  const Probe& chosen = chooseDevice(probes, options.choice);
  if (!options.windowExtensions.empty()) requireSwapchain(chosen);
  info_ = chosen.info;
  physical_ = chosen.physical;
  queueFamily_ = chosen.queueFamily;
  createHandle(!options.windowExtensions.empty());
  createServices(options.cacheFolder);
}

/// What Weir puts beside the device, whoever's it is.
void Device::createServices(const std::string& cache) {
  createAllocator();
  cacheFolder_ = cacheFolder(cache);
  pipelineCache_ = loadPipelineCache(device_, physical_, cacheFolder_);
  const VkCommandPoolCreateInfo pool{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                     .flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT,
                                     .queueFamilyIndex = queueFamily_};
  check(vkCreateCommandPool(device_, &pool, nullptr, &immediatePool_), "vkCreateCommandPool");
  const VkFenceCreateInfo fence{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  check(vkCreateFence(device_, &fence, nullptr, &immediate_->fence), "vkCreateFence");
}

void Device::createHandle(bool shows) {
  const Capabilities& has = info_.capabilities;
  FeatureChain wanted(has.accelerationStructure, has.rayPipeline, has.rayQuery);
  wantFeatures(physical_, has, wanted);

  std::vector<const char*> extensions = deviceExtensions(has);
  if (shows) extensions.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
  const float priority = 1.0f;
  const VkDeviceQueueCreateInfo queue{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                      .queueFamilyIndex = queueFamily_,
                                      .queueCount = 1,
                                      .pQueuePriorities = &priority};
  const VkDeviceCreateInfo info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                .pNext = &wanted.core,
                                .queueCreateInfoCount = 1,
                                .pQueueCreateInfos = &queue,
                                .enabledExtensionCount = static_cast<uint32_t>(extensions.size()),
                                .ppEnabledExtensionNames = extensions.data()};
  check(vkCreateDevice(physical_, &info, nullptr, &device_), "vkCreateDevice");
  vkGetDeviceQueue(device_, queueFamily_, 0, &queue_);
}

void Device::createAllocator() {
  const VmaVulkanFunctions functions{.vkGetInstanceProcAddr = vkGetInstanceProcAddr,
                                     .vkGetDeviceProcAddr = vkGetDeviceProcAddr};
  const VmaAllocatorCreateInfo info{.flags = VMA_ALLOCATOR_CREATE_BUFFER_DEVICE_ADDRESS_BIT,
                                    .physicalDevice = physical_,
                                    .device = device_,
                                    .pVulkanFunctions = &functions,
                                    .instance = instance_,
                                    .vulkanApiVersion = VK_API_VERSION_1_3};
  check(vmaCreateAllocator(&info, &allocator_), "vmaCreateAllocator");
}

void Device::destroy() noexcept {
  if (device_) {
    if (owned_)
      vkDeviceWaitIdle(device_);
    else
      vkQueueWaitIdle(queue_);  // the host's other queues are no concern of this one
    try {
      savePipelineCache(device_, physical_, pipelineCache_, cacheFolder_);
    } catch (...) {
      // Losing the cache costs time in the next run, nothing else.
    }
    vkDestroyFence(device_, immediate_->fence, nullptr);
    vkDestroyCommandPool(device_, immediatePool_, nullptr);
    vkDestroyPipelineCache(device_, pipelineCache_, nullptr);
    if (allocator_) vmaDestroyAllocator(allocator_);
    if (owned_) vkDestroyDevice(device_, nullptr);
  }
  if (!owned_) return;
  if (messenger_) vkDestroyDebugUtilsMessengerEXT(instance_, messenger_, nullptr);
  if (instance_) vkDestroyInstance(instance_, nullptr);
}

void Device::name(VkObjectType type, uint64_t handle, const std::string& name) const {
  if (!debugUtils_ || handle == 0) return;
  const VkDebugUtilsObjectNameInfoEXT info{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT,
                                           .objectType = type,
                                           .objectHandle = handle,
                                           .pObjectName = name.c_str()};
  vkSetDebugUtilsObjectNameEXT(device_, &info);
}

void Device::beginLabel(VkCommandBuffer commands, const char* name) const {
  if (!debugUtils_) return;
  const VkDebugUtilsLabelEXT label{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT, .pLabelName = name};
  vkCmdBeginDebugUtilsLabelEXT(commands, &label);
}

void Device::endLabel(VkCommandBuffer commands) const {
  if (debugUtils_) vkCmdEndDebugUtilsLabelEXT(commands);
}

void Device::submitAndWait(const std::function<void(VkCommandBuffer)>& record) const {
  const std::lock_guard lock(immediate_->mutex);
  const VkCommandBufferAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                             .commandPool = immediatePool_,
                                             .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                             .commandBufferCount = 1};
  VkCommandBuffer commands = VK_NULL_HANDLE;
  check(vkAllocateCommandBuffers(device_, &allocate, &commands), "vkAllocateCommandBuffers");
  try {
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    check(vkBeginCommandBuffer(commands, &begin), "vkBeginCommandBuffer");
    record(commands);
    check(vkEndCommandBuffer(commands), "vkEndCommandBuffer");
    const VkCommandBufferSubmitInfo buffer{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                           .commandBuffer = commands};
    const VkSubmitInfo2 submit{
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2, .commandBufferInfoCount = 1, .pCommandBufferInfos = &buffer};
    check(vkQueueSubmit2(queue_, 1, &submit, immediate_->fence), "vkQueueSubmit2");
    check(vkWaitForFences(device_, 1, &immediate_->fence, VK_TRUE, UINT64_MAX), "vkWaitForFences");
    check(vkResetFences(device_, 1, &immediate_->fence), "vkResetFences");
  } catch (...) {
    vkFreeCommandBuffers(device_, immediatePool_, 1, &commands);
    throw;
  }
  vkFreeCommandBuffers(device_, immediatePool_, 1, &commands);
}

void Device::waitIdle() const {
  check(vkDeviceWaitIdle(device_), "vkDeviceWaitIdle");
}

const std::vector<ValidationMessage>& Device::validationMessages() const {
  const std::lock_guard lock(messages_->mutex);
  messages_->handedOut = messages_->all;
  return messages_->handedOut;
}

void Device::clearValidationMessages() {
  const std::lock_guard lock(messages_->mutex);
  messages_->all.clear();
}

}  // namespace weir::gpu
