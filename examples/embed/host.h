/* The part of a host that has nothing to do with Weir: instance, device, images, a frame's command buffer. */
#ifndef EXAMPLE_HOST_H
#define EXAMPLE_HOST_H

#include <stdint.h>
#include <vulkan/vulkan.h>

enum { kFramesInFlight = 2 };

/* Ends the program with a message when a Vulkan call fails. */
void must(VkResult result, const char* call);
#define VK(call) must((call), #call)

typedef struct Host {
  VkInstance instance;
  VkDebugUtilsMessengerEXT messenger; /* with validation */
  uint32_t messages;                  /* of the validation layers so far */
  VkPhysicalDevice physical;
  VkPhysicalDeviceMemoryProperties memory;
  VkDevice device;
  VkQueue queue;
  uint32_t queueFamily;
} Host;

typedef struct Image {
  VkImage image;
  VkDeviceMemory memory;
  VkImageView view;
  VkFormat format;
  uint32_t width, height;
  VkImageUsageFlags usage;
} Image;

typedef struct Readback {
  VkBuffer buffer;
  VkDeviceMemory memory;
  const float* pixels;
} Readback;

/* Chooses the device whose name contains `name` (NULL: the first) and its first family that draws and computes. */
void makeInstance(Host* host, int validate, const char* name);
/* `features`: VkDeviceCreateInfo::pNext. */
void makeDevice(Host* host, const void* features, const char* const* extensions, uint32_t extensionCount);
void destroyHost(Host* host);

Image makeImage(const Host* host, VkFormat format, uint32_t width, uint32_t height, VkImageUsageFlags usage);
void destroyImage(const Host* host, Image* image);
Readback makeReadback(const Host* host, VkDeviceSize bytes);
void destroyReadback(const Host* host, Readback* readback);

/* What was done to an image and what will be. */
typedef struct Use {
  VkPipelineStageFlags2 stages;
  VkAccessFlags2 access;
  VkImageLayout layout;
} Use;
void barrier(VkCommandBuffer commands, const Image* image, Use from, Use to);

#endif
