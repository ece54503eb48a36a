#include "host.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void must(VkResult result, const char* call) {
  if (result == VK_SUCCESS) return;
  fprintf(stderr, "%s failed with VkResult %d\n", call, (int)result);
  exit(1);
}

static VkBool32 VKAPI_PTR hear(VkDebugUtilsMessageSeverityFlagBitsEXT severity, VkDebugUtilsMessageTypeFlagsEXT types,
                               const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  (void)severity;
  (void)types;
  fprintf(stderr, "validation: %s\n", data->pMessage);
  ++((Host*)user)->messages;
  return VK_FALSE;
}

void makeInstance(Host* host, int validate, const char* name) {
  const char* const layer = "VK_LAYER_KHRONOS_validation";
  const char* const extensions[] = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};
  const VkDebugUtilsMessengerCreateInfoEXT messenger = {
      .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
      .messageSeverity =
          VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
      .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
      .pfnUserCallback = hear,
      .pUserData = host};
  const VkValidationFeatureEnableEXT synchronization = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
  const VkValidationFeaturesEXT validation = {.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                              .pNext = &messenger,
                                              .enabledValidationFeatureCount = 1,
                                              .pEnabledValidationFeatures = &synchronization};
  const VkApplicationInfo application = {
      .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .pApplicationName = "embed", .apiVersion = VK_API_VERSION_1_3};
  const VkInstanceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                     .pNext = validate ? &validation : NULL,
                                     .pApplicationInfo = &application,
                                     .enabledLayerCount = validate ? 1 : 0,
                                     .ppEnabledLayerNames = &layer,
                                     .enabledExtensionCount = validate ? 2 : 0,
                                     .ppEnabledExtensionNames = extensions};
  VK(vkCreateInstance(&info, NULL, &host->instance));
  if (validate) {
    const PFN_vkCreateDebugUtilsMessengerEXT create =
        (PFN_vkCreateDebugUtilsMessengerEXT)vkGetInstanceProcAddr(host->instance, "vkCreateDebugUtilsMessengerEXT");
    VK(create(host->instance, &messenger, NULL, &host->messenger));
  }

  VkPhysicalDevice devices[16];
  uint32_t count = 16;
  const VkResult result = vkEnumeratePhysicalDevices(host->instance, &count, devices);
  if (result != VK_INCOMPLETE) must(result, "vkEnumeratePhysicalDevices");
  for (uint32_t i = 0; i < count && host->physical == VK_NULL_HANDLE; ++i) {
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(devices[i], &properties);
    if (name == NULL || strstr(properties.deviceName, name) != NULL) host->physical = devices[i];
  }
  if (host->physical == VK_NULL_HANDLE) {
    fprintf(stderr, "no Vulkan device has '%s' in its name\n", name == NULL ? "" : name);
    exit(2);
  }
  vkGetPhysicalDeviceMemoryProperties(host->physical, &host->memory);
  VkQueueFamilyProperties families[32];
  count = 32;
  vkGetPhysicalDeviceQueueFamilyProperties(host->physical, &count, families);
  const VkQueueFlags wanted = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
  while (host->queueFamily < count && (families[host->queueFamily].queueFlags & wanted) != wanted) ++host->queueFamily;
  if (host->queueFamily == count) {
    fprintf(stderr, "the device has no queue family that draws and computes\n");
    exit(1);
  }
}

void makeDevice(Host* host, const void* features, const char* const* extensions, uint32_t extensionCount) {
  const float priority = 1.0f;
  const VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                         .queueFamilyIndex = host->queueFamily,
                                         .queueCount = 1,
                                         .pQueuePriorities = &priority};
  const VkDeviceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                   .pNext = features,
                                   .queueCreateInfoCount = 1,
                                   .pQueueCreateInfos = &queue,
                                   .enabledExtensionCount = extensionCount,
                                   .ppEnabledExtensionNames = extensions};
  VK(vkCreateDevice(host->physical, &info, NULL, &host->device));
  vkGetDeviceQueue(host->device, host->queueFamily, 0, &host->queue);
}

void destroyHost(Host* host) {
  vkDestroyDevice(host->device, NULL);
  if (host->messenger != VK_NULL_HANDLE) {
    const PFN_vkDestroyDebugUtilsMessengerEXT destroy =
        (PFN_vkDestroyDebugUtilsMessengerEXT)vkGetInstanceProcAddr(host->instance, "vkDestroyDebugUtilsMessengerEXT");
    destroy(host->instance, host->messenger, NULL);
  }
  vkDestroyInstance(host->instance, NULL);
}

static VkDeviceMemory allocate(const Host* host, VkMemoryRequirements asked, VkMemoryPropertyFlags wanted) {
  for (uint32_t i = 0; i < host->memory.memoryTypeCount; ++i) {
    if (!(asked.memoryTypeBits & (1u << i))) continue;
    if ((host->memory.memoryTypes[i].propertyFlags & wanted) != wanted) continue;
    const VkMemoryAllocateInfo info = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = asked.size, .memoryTypeIndex = i};
    VkDeviceMemory memory;
    VK(vkAllocateMemory(host->device, &info, NULL, &memory));
    return memory;
  }
  fprintf(stderr, "the device has no fitting memory type\n");
  exit(1);
}

Image makeImage(const Host* host, VkFormat format, uint32_t width, uint32_t height, VkImageUsageFlags usage) {
  Image made = {.format = format, .width = width, .height = height, .usage = usage};
  const VkImageCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                  .imageType = VK_IMAGE_TYPE_2D,
                                  .format = format,
                                  .extent = {width, height, 1},
                                  .mipLevels = 1,
                                  .arrayLayers = 1,
                                  .samples = VK_SAMPLE_COUNT_1_BIT,
                                  .tiling = VK_IMAGE_TILING_OPTIMAL,
                                  .usage = usage};
  VK(vkCreateImage(host->device, &info, NULL, &made.image));
  VkMemoryRequirements asked;
  vkGetImageMemoryRequirements(host->device, made.image, &asked);
  made.memory = allocate(host, asked, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  VK(vkBindImageMemory(host->device, made.image, made.memory, 0));
  if (!(usage & VK_IMAGE_USAGE_STORAGE_BIT)) return made;
  const VkImageViewCreateInfo view = {.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                      .image = made.image,
                                      .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                      .format = format,
                                      .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
  VK(vkCreateImageView(host->device, &view, NULL, &made.view));
  return made;
}

void destroyImage(const Host* host, Image* image) {
  vkDestroyImageView(host->device, image->view, NULL);
  vkDestroyImage(host->device, image->image, NULL);
  vkFreeMemory(host->device, image->memory, NULL);
}

Readback makeReadback(const Host* host, VkDeviceSize bytes) {
  Readback made;
  const VkBufferCreateInfo info = {
      .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = bytes, .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT};
  VK(vkCreateBuffer(host->device, &info, NULL, &made.buffer));
  VkMemoryRequirements asked;
  vkGetBufferMemoryRequirements(host->device, made.buffer, &asked);
  made.memory = allocate(host, asked, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
  VK(vkBindBufferMemory(host->device, made.buffer, made.memory, 0));
  void* mapped;
  VK(vkMapMemory(host->device, made.memory, 0, VK_WHOLE_SIZE, 0, &mapped));
  made.pixels = mapped;
  return made;
}

void destroyReadback(const Host* host, Readback* readback) {
  vkDestroyBuffer(host->device, readback->buffer, NULL);
  vkFreeMemory(host->device, readback->memory, NULL);
}

void barrier(VkCommandBuffer commands, const Image* image, Use from, Use to) {
  const VkImageMemoryBarrier2 b = {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
                                   .srcStageMask = from.stages,
                                   .srcAccessMask = from.access,
                                   .dstStageMask = to.stages,
                                   .dstAccessMask = to.access,
                                   .oldLayout = from.layout,
                                   .newLayout = to.layout,
                                   .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                   .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                   .image = image->image,
                                   .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
  const VkDependencyInfo info = {
      .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .imageMemoryBarrierCount = 1, .pImageMemoryBarriers = &b};
  vkCmdPipelineBarrier2(commands, &info);
}
