#include "host.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace weir::test {
namespace {

void must(VkResult result) {
  if (result != VK_SUCCESS) throw std::runtime_error("VkResult " + std::to_string(result));
}

// The functions that are watched, passed on.
PFN_vkVoidFunction VKAPI_PTR procAddr(VkInstance instance, const char* name);

VkResult VKAPI_PTR submit2(VkQueue queue, uint32_t count, const VkSubmitInfo2* submits, VkFence fence) {
  ++watched().submits;
  return vkQueueSubmit2(queue, count, submits, fence);
}
VkResult VKAPI_PTR waitForFences(VkDevice device, uint32_t count, const VkFence* fences, VkBool32 all, uint64_t time) {
  ++watched().waits;
  return vkWaitForFences(device, count, fences, all, time);
}
VkResult VKAPI_PTR waitIdle(VkDevice device) {
  ++watched().waits;
  return vkDeviceWaitIdle(device);
}
PFN_vkSetDebugUtilsObjectNameEXT setName = nullptr;
VkResult VKAPI_PTR setObjectName(VkDevice device, const VkDebugUtilsObjectNameInfoEXT* info) {
  ++watched().names;
  return setName(device, info);
}
PFN_vkCmdBeginDebugUtilsLabelEXT begin = nullptr;
void VKAPI_PTR beginLabel(VkCommandBuffer commands, const VkDebugUtilsLabelEXT* label) {
  ++watched().labels;
  begin(commands, label);
}

PFN_vkVoidFunction VKAPI_PTR procAddr(VkInstance instance, const char* name) {
  const PFN_vkVoidFunction found = vkGetInstanceProcAddr(instance, name);
  const auto is = [name](const char* other) { return std::strcmp(name, other) == 0; };
  if (found == nullptr) return nullptr;
  if (is("vkQueueSubmit2")) return reinterpret_cast<PFN_vkVoidFunction>(submit2);
  if (is("vkWaitForFences")) return reinterpret_cast<PFN_vkVoidFunction>(waitForFences);
  if (is("vkDeviceWaitIdle")) return reinterpret_cast<PFN_vkVoidFunction>(waitIdle);
  if (is("vkSetDebugUtilsObjectNameEXT")) {
    setName = reinterpret_cast<PFN_vkSetDebugUtilsObjectNameEXT>(found);
    return reinterpret_cast<PFN_vkVoidFunction>(setObjectName);
  }
  if (is("vkCmdBeginDebugUtilsLabelEXT")) {
    begin = reinterpret_cast<PFN_vkCmdBeginDebugUtilsLabelEXT>(found);
    return reinterpret_cast<PFN_vkVoidFunction>(beginLabel);
  }
  return found;
}

VkBool32 VKAPI_PTR hear(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                        const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  static_cast<std::vector<std::string>*>(user)->emplace_back(data->pMessage);
  return VK_FALSE;
}

}  // namespace

Watched& watched() {
  static Watched counts;
  return counts;
}

Host::Host(const HostOptions& options) {
  WeirOpenInfo open{.size = sizeof(WeirOpenInfo)};
  if (weirOpen(&open, &weir_) != WEIR_OK) throw std::runtime_error("weirOpen");
  makeInstance(options.debugUtils);
  makeDevice(options);
  const VkCommandPoolCreateInfo pool{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                     .queueFamilyIndex = info_.queueFamily};
  must(vkCreateCommandPool(info_.device, &pool, nullptr, &pool_));
}

void Host::makeInstance(bool debugUtils) {
  const VkDebugUtilsMessengerCreateInfoEXT messenger{
      .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
      .messageSeverity =
          VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
      .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
      .pfnUserCallback = hear,
      .pUserData = &messages_};
  const VkValidationFeatureEnableEXT synchronization = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
  const VkValidationFeaturesEXT validation{.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                           .pNext = &messenger,
                                           .enabledValidationFeatureCount = 1,
                                           .pEnabledValidationFeatures = &synchronization};
  const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = VK_API_VERSION_1_3};
  const char* layer = "VK_LAYER_KHRONOS_validation";
  if (debugUtils) instanceExtensions_ = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};
  const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                  .pNext = debugUtils ? &validation : nullptr,
                                  .pApplicationInfo = &application,
                                  .enabledLayerCount = debugUtils ? 1u : 0u,
                                  .ppEnabledLayerNames = &layer,
                                  .enabledExtensionCount = static_cast<uint32_t>(instanceExtensions_.size()),
                                  .ppEnabledExtensionNames = instanceExtensions_.data()};
  must(vkCreateInstance(&info, nullptr, &info_.instance));
  if (!debugUtils) return;
  const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
      vkGetInstanceProcAddr(info_.instance, "vkCreateDebugUtilsMessengerEXT"));
  must(create(info_.instance, &messenger, nullptr, &messenger_));
}

/// The tests' own device is the CPU's, so that they run everywhere and alike.
void Host::makeDevice(const HostOptions& options) {
  std::array<VkPhysicalDevice, 16> devices{};
  uint32_t count = devices.size();
  const VkResult result = vkEnumeratePhysicalDevices(info_.instance, &count, devices.data());
  if (result != VK_INCOMPLETE) must(result);
  for (uint32_t i = 0; i < count; ++i) {
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(devices[i], &properties);
    if (properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU) info_.physicalDevice = devices[i];
  }
  info_.size = sizeof info_;
  info_.getInstanceProcAddr = procAddr;
  info_.apiVersion = VK_API_VERSION_1_3;
  info_.instanceExtensions = {instanceExtensions_.data(), static_cast<uint32_t>(instanceExtensions_.size())};
  if (weirCreateNeeds(weir_, &info_, &needs_) != WEIR_OK) throw std::runtime_error(message());
  const WeirTexts extensions = weirNeededExtensions(needs_);
  deviceExtensions_.assign(extensions.texts, extensions.texts + extensions.count);
  VkPhysicalDeviceFeatures2* features = weirNeededFeatures(needs_);
  if (options.adjust) options.adjust(*features, deviceExtensions_);
  info_.features = features;
  info_.deviceExtensions = {deviceExtensions_.data(), static_cast<uint32_t>(deviceExtensions_.size())};

  const float priority = 1.0f;
  const VkDeviceQueueCreateInfo queue{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                      .queueFamilyIndex = 0,
                                      .queueCount = 1,
                                      .pQueuePriorities = &priority};
  const VkDeviceCreateInfo device{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                  .pNext = features,
                                  .queueCreateInfoCount = 1,
                                  .pQueueCreateInfos = &queue,
                                  .enabledExtensionCount = info_.deviceExtensions.count,
                                  .ppEnabledExtensionNames = info_.deviceExtensions.texts};
  must(vkCreateDevice(info_.physicalDevice, &device, nullptr, &info_.device));
  vkGetDeviceQueue(info_.device, 0, 0, &info_.queue);
}

Host::~Host() {
  vkDeviceWaitIdle(info_.device);
  EXPECT_EQ(weirDestroyContext(context_), WEIR_OK) << message();
  EXPECT_EQ(weirDestroyNeeds(needs_), WEIR_OK);
  EXPECT_EQ(weirClose(weir_), WEIR_OK) << message();
  for (const HostImage& i : images_) {
    vkDestroyImageView(info_.device, i.view, nullptr);
    vkDestroyImage(info_.device, i.image, nullptr);
    vkFreeMemory(info_.device, i.memory, nullptr);
  }
  for (const HostBuffer& b : buffers_) {
    vkDestroyBuffer(info_.device, b.buffer, nullptr);
    vkFreeMemory(info_.device, b.memory, nullptr);
  }
  for (VkQueryPool pool : queries_) vkDestroyQueryPool(info_.device, pool, nullptr);
  vkDestroyCommandPool(info_.device, pool_, nullptr);
  vkDestroyDevice(info_.device, nullptr);
  if (messenger_ != VK_NULL_HANDLE) {
    const auto destroy = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(info_.instance, "vkDestroyDebugUtilsMessengerEXT"));
    destroy(info_.instance, messenger_, nullptr);
  }
  vkDestroyInstance(info_.instance, nullptr);
  for (const std::string& text : messages_) ADD_FAILURE() << text;
}

WeirContext* Host::context() {
  if (context_ == nullptr && weirCreateContext(weir_, &info_, &context_) != WEIR_OK)
    throw std::runtime_error(message());
  return context_;
}

std::vector<std::string> Host::lines() const {
  const WeirTexts all = weirLines(weir_);
  return {all.texts, all.texts + all.count};
}

VkDeviceMemory Host::allocate(const VkMemoryRequirements& asked, VkMemoryPropertyFlags wanted) {
  VkPhysicalDeviceMemoryProperties properties;
  vkGetPhysicalDeviceMemoryProperties(info_.physicalDevice, &properties);
  for (uint32_t i = 0; i < properties.memoryTypeCount; ++i) {
    if ((asked.memoryTypeBits & (1u << i)) == 0) continue;
    if ((properties.memoryTypes[i].propertyFlags & wanted) != wanted) continue;
    const VkMemoryAllocateInfo info{
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = asked.size, .memoryTypeIndex = i};
    VkDeviceMemory memory = VK_NULL_HANDLE;
    must(vkAllocateMemory(info_.device, &info, nullptr, &memory));
    return memory;
  }
  throw std::runtime_error("no memory type fits");
}

HostImage Host::image(VkFormat format, uint32_t width, uint32_t height, VkImageUsageFlags usage) {
  HostImage made{.format = format, .width = width, .height = height, .usage = usage};
  const VkImageCreateInfo info{.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                               .imageType = VK_IMAGE_TYPE_2D,
                               .format = format,
                               .extent = {width, height, 1},
                               .mipLevels = 1,
                               .arrayLayers = 1,
                               .samples = VK_SAMPLE_COUNT_1_BIT,
                               .usage = usage};
  must(vkCreateImage(info_.device, &info, nullptr, &made.image));
  VkMemoryRequirements asked;
  vkGetImageMemoryRequirements(info_.device, made.image, &asked);
  made.memory = allocate(asked, 0);
  must(vkBindImageMemory(info_.device, made.image, made.memory, 0));
  const VkImageViewCreateInfo view{.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                   .image = made.image,
                                   .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                   .format = format,
                                   .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
  must(vkCreateImageView(info_.device, &view, nullptr, &made.view));
  images_.push_back(made);
  return made;
}

HostBuffer Host::buffer(VkDeviceSize bytes) {
  HostBuffer made{.bytes = bytes};
  const VkBufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                .size = bytes,
                                .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT};
  must(vkCreateBuffer(info_.device, &info, nullptr, &made.buffer));
  VkMemoryRequirements asked;
  vkGetBufferMemoryRequirements(info_.device, made.buffer, &asked);
  made.memory = allocate(asked, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
  must(vkBindBufferMemory(info_.device, made.buffer, made.memory, 0));
  void* mapped = nullptr;
  must(vkMapMemory(info_.device, made.memory, 0, VK_WHOLE_SIZE, 0, &mapped));
  made.mapped = static_cast<float*>(mapped);
  buffers_.push_back(made);
  return made;
}

VkQueryPool Host::queries(uint32_t count) {
  const VkQueryPoolCreateInfo info{
      .sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO, .queryType = VK_QUERY_TYPE_TIMESTAMP, .queryCount = count};
  VkQueryPool pool = VK_NULL_HANDLE;
  must(vkCreateQueryPool(info_.device, &info, nullptr, &pool));
  queries_.push_back(pool);
  return pool;
}

void Host::run(const std::function<void(VkCommandBuffer)>& record, bool wait) {
  const VkCommandBufferAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                             .commandPool = pool_,
                                             .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                             .commandBufferCount = 1};
  VkCommandBuffer commands = VK_NULL_HANDLE;
  must(vkAllocateCommandBuffers(info_.device, &allocate, &commands));
  const VkCommandBufferBeginInfo start{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                       .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
  must(vkBeginCommandBuffer(commands, &start));
  record(commands);
  must(vkEndCommandBuffer(commands));
  const VkCommandBufferSubmitInfo buffer{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                         .commandBuffer = commands};
  const VkSubmitInfo2 submit{
      .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2, .commandBufferInfoCount = 1, .pCommandBufferInfos = &buffer};
  must(vkQueueSubmit2(info_.queue, 1, &submit, VK_NULL_HANDLE));
  if (wait) idle();
}

void Host::idle() {
  must(vkQueueWaitIdle(info_.queue));
}

void barrier(VkCommandBuffer commands, const HostImage& image, const WeirAccess& from, const WeirAccess& to) {
  const VkImageMemoryBarrier2 b{.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
                                .srcStageMask = from.stages,
                                .srcAccessMask = from.access,
                                .dstStageMask = to.stages,
                                .dstAccessMask = to.access,
                                .oldLayout = from.layout,
                                .newLayout = to.layout,
                                .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                .image = image.image,
                                .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
  const VkDependencyInfo info{
      .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .imageMemoryBarrierCount = 1, .pImageMemoryBarriers = &b};
  vkCmdPipelineBarrier2(commands, &info);
}

}  // namespace weir::test
