// What this room's files share: instances, what a physical device has, and the features that Weir asks for. Not for
// others.
#pragma once

#include <weir/gpu/device.h>

#include <string>
#include <vector>

namespace weir::gpu {

/// Every feature structure that Weir looks at, linked into one chain. It holds pointers to itself: never copied.
struct FeatureChain {
  /// Links the optional structures only where the device knows them.
  FeatureChain(bool accelerationStructure, bool rayPipeline, bool rayQuery);
  FeatureChain(const FeatureChain&) = delete;
  FeatureChain& operator=(const FeatureChain&) = delete;

  VkPhysicalDeviceFeatures2 core{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
  VkPhysicalDeviceVulkan11Features v11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES};
  VkPhysicalDeviceVulkan12Features v12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
  VkPhysicalDeviceVulkan13Features v13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
  VkPhysicalDeviceAccelerationStructureFeaturesKHR acceleration{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR};
  VkPhysicalDeviceRayTracingPipelineFeaturesKHR rayPipelines{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_FEATURES_KHR};
  VkPhysicalDeviceRayQueryFeaturesKHR rayQueries{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR};
};

/// What a chain in the host's own structures, of any version or extension, switches on. Those that are not there are
/// off.
void takeEnabled(const VkPhysicalDeviceFeatures2* enabled, FeatureChain& chain);

/// A feature by its name and its place. Weir cannot do without the required ones; the others are taken where they
/// exist.
struct FeatureRule {
  const char* name;
  bool required;
  VkBool32& (*field)(FeatureChain&);
};
const std::vector<FeatureRule>& featureRules();
/// Switches on everything that the device has of them. `chain` is made for the same capabilities.
void wantFeatures(VkPhysicalDevice physical, const Capabilities& has, FeatureChain& chain);

/// A physical device, what it has, and which queue family Weir would take.
struct Probe {
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  DeviceInfo info;
  uint32_t queueFamily = 0;
};

/// Sees to it that Vulkan's entry points are there and that they are those of `loader`, when it is given. RuntimeError
/// when there is no Vulkan, or when the process has it from another loader already.
void loadVulkan(PFN_vkGetInstanceProcAddr loader);

/// Loads the Vulkan library once per process and creates an instance. RuntimeError when there is no Vulkan or no
/// driver. `messages`, when given, also hears about the instance's own creation; it needs `validation`. InputError
/// where one of the `wanted` extensions isn't there.
VkInstance createInstance(bool validation, const VkDebugUtilsMessengerCreateInfoEXT* messages,
                          const std::vector<std::string>& wanted = {});

/// Whether instances get VK_EXT_debug_utils (object names and labels). Only after `createInstance`.
bool hasDebugUtils();

/// Looks at one physical device: what it could do. `options` hides what the user wants hidden.
Probe probeDevice(VkPhysicalDevice physical, uint32_t index, const DeviceOptions& options);

/// Looks at every physical device. `options` hides what the user wants hidden.
std::vector<Probe> probeDevices(VkInstance instance, const DeviceOptions& options);

/// The probe that `choice` means. InputError says what there is when nothing fits or the chosen one lacks something.
const Probe& chooseDevice(const std::vector<Probe>& probes, const std::string& choice);

/// Extensions to enable for these capabilities.
std::vector<const char*> deviceExtensions(const Capabilities& capabilities);

/// InputError, naming the device, unless it can show pictures in windows.
void requireSwapchain(const Probe& probe);

/// "1.3.275"
std::string versionText(uint32_t version);

/// A pipeline cache filled from `folder` ("-" or nothing readable there: an empty one), and the way back to disk.
VkPipelineCache loadPipelineCache(VkDevice device, VkPhysicalDevice physical, const std::string& folder);
void savePipelineCache(VkDevice device, VkPhysicalDevice physical, VkPipelineCache cache, const std::string& folder);

}  // namespace weir::gpu
