// Looking at the physical devices of an instance, and choosing one.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <weir/core/error.h>
#include <weir/gpu/probe.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <set>

namespace weir::gpu {
namespace {

const char* kindName(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return "discrete";
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return "integrated";
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return "virtual";
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return "cpu";
    default:
      return "other";
  }
}

std::set<std::string> extensionNames(VkPhysicalDevice physical) {
  uint32_t count = 0;
  vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> extensions(count);
  vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, extensions.data());
  std::set<std::string> names;
  for (const VkExtensionProperties& extension : extensions) names.insert(extension.extensionName);
  return names;
}

/// Prefers a family that rasterises and computes, then one that computes. False when there is none.
bool findQueueFamily(Probe& probe) {
  uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(probe.physical, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(probe.physical, &count, families.data());
  bool found = false;
  for (uint32_t i = 0; i < count; ++i) {
    const VkQueueFlags flags = families[i].queueFlags;
    const bool graphics = (flags & VK_QUEUE_GRAPHICS_BIT) != 0;
    if (!(flags & VK_QUEUE_COMPUTE_BIT) || families[i].queueCount == 0) continue;
    if (found && !(graphics && !probe.info.capabilities.graphics)) continue;
    found = true;
    probe.queueFamily = i;
    probe.info.capabilities.graphics = graphics;
    if (families[i].timestampValidBits == 0) probe.info.capabilities.timestampPeriod = 0.0f;
  }
  return found;
}

void readLimits(Probe& probe, bool acceleration, bool rayPipeline, bool updateAfterBind) {
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
  VkPhysicalDeviceVulkan11Properties v11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES};
  VkPhysicalDeviceVulkan12Properties v12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_PROPERTIES};
  VkPhysicalDeviceAccelerationStructurePropertiesKHR structures{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_PROPERTIES_KHR};
  VkPhysicalDeviceRayTracingPipelinePropertiesKHR pipelines{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_PROPERTIES_KHR};
  properties.pNext = &v11;
  v11.pNext = &v12;
  void** tail = &v12.pNext;
  if (acceleration) {
    *tail = &structures;
    tail = &structures.pNext;
  }
  if (rayPipeline) *tail = &pipelines;
  vkGetPhysicalDeviceProperties2(probe.physical, &properties);

  Capabilities& has = probe.info.capabilities;
  has.subgroupSize = v11.subgroupSize;
  has.minScratchAlignment = structures.minAccelerationStructureScratchOffsetAlignment;
  has.shaderGroupHandleSize = pipelines.shaderGroupHandleSize;
  has.shaderGroupHandleAlignment = pipelines.shaderGroupHandleAlignment;
  has.shaderGroupBaseAlignment = pipelines.shaderGroupBaseAlignment;
  const VkPhysicalDeviceLimits& limits = properties.properties.limits;
  // Textures are bound with their samplers, so both counts limit the array.
  has.maxTextures =
      updateAfterBind
          ? std::min({v12.maxPerStageDescriptorUpdateAfterBindSampledImages,
                      v12.maxDescriptorSetUpdateAfterBindSampledImages,
                      v12.maxPerStageDescriptorUpdateAfterBindSamplers, v12.maxDescriptorSetUpdateAfterBindSamplers})
          : std::min({limits.maxPerStageDescriptorSampledImages, limits.maxDescriptorSetSampledImages,
                      limits.maxPerStageDescriptorSamplers, limits.maxDescriptorSetSamplers});
  probe.info.driver = fmt::format("{} {}", v12.driverName, v12.driverInfo);
}

void readFeatures(Probe& probe, const DeviceOptions& options) {
  const std::set<std::string> extensions = extensionNames(probe.physical);
  const auto has = [&extensions](const char* name) { return extensions.contains(name); };
  const bool acceleration = !options.hideRayTracing && has(VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME) &&
                            has(VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME);
  const bool pipeline = acceleration && !options.hideRayPipeline && has(VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME);
  const bool query = acceleration && !options.hideRayQuery && has(VK_KHR_RAY_QUERY_EXTENSION_NAME);

  FeatureChain chain(acceleration, pipeline, query);
  vkGetPhysicalDeviceFeatures2(probe.physical, &chain.core);
  for (const FeatureRule& rule : featureRules()) {
    if (rule.required && !rule.field(chain)) probe.info.missing.push_back(rule.name);
  }
  Capabilities& capabilities = probe.info.capabilities;
  capabilities.accelerationStructure = acceleration && chain.acceleration.accelerationStructure;
  capabilities.rayPipeline = capabilities.accelerationStructure && pipeline && chain.rayPipelines.rayTracingPipeline;
  capabilities.rayQuery = capabilities.accelerationStructure && query && chain.rayQueries.rayQuery;
  capabilities.doubles = chain.core.features.shaderFloat64;
  readLimits(probe, capabilities.accelerationStructure, capabilities.rayPipeline,
             chain.v12.descriptorBindingSampledImageUpdateAfterBind);
}

std::string lowered(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string listing(const std::vector<Probe>& probes) {
  std::string text;
  for (const Probe& probe : probes) {
    text += fmt::format("\n  {}: {} ({})", probe.info.index, probe.info.name, probe.info.kind);
    if (!probe.info.missing.empty()) text += fmt::format(", lacks {}", fmt::join(probe.info.missing, ", "));
  }
  return text.empty() ? "\n  none" : text;
}

/// Higher is better: usable, then by kind, then rays, then raster.
int rank(const Probe& probe) {
  static constexpr const char* kKinds[] = {"other", "cpu", "virtual", "integrated", "discrete"};
  const auto kind = std::ranges::find(kKinds, probe.info.kind) - std::begin(kKinds);
  const Capabilities& has = probe.info.capabilities;
  return (probe.info.missing.empty() ? 1000 : 0) + static_cast<int>(kind) * 100 +
         (has.rayPipeline || has.rayQuery ? 10 : 0) + (has.graphics ? 1 : 0);
}

}  // namespace

Probe probeDevice(VkPhysicalDevice physical, uint32_t index, const DeviceOptions& options) {
  Probe probe{.physical = physical};
  VkPhysicalDeviceProperties properties;
  vkGetPhysicalDeviceProperties(physical, &properties);
  probe.info.index = index;
  probe.info.name = properties.deviceName;
  probe.info.kind = kindName(properties.deviceType);
  probe.info.apiVersion = properties.apiVersion;
  probe.info.driver = fmt::format("driver {:#x}", properties.driverVersion);
  Capabilities& capabilities = probe.info.capabilities;
  capabilities.graphics = false;
  capabilities.timestampPeriod = properties.limits.timestampPeriod;
  capabilities.maxStorageBufferRange = properties.limits.maxStorageBufferRange;
  if (!findQueueFamily(probe)) probe.info.missing.push_back("a queue that computes");
  // Older devices don't know the structures that the rest would ask for.
  if (properties.apiVersion < VK_API_VERSION_1_3) {
    probe.info.missing.push_back(fmt::format("Vulkan 1.3 (it has {})", versionText(properties.apiVersion)));
  } else {
    readFeatures(probe, options);
  }
  return probe;
}

std::vector<Probe> probeDevices(VkInstance instance, const DeviceOptions& options) {
  uint32_t count = 0;
  check(vkEnumeratePhysicalDevices(instance, &count, nullptr), "vkEnumeratePhysicalDevices");
  std::vector<VkPhysicalDevice> devices(count);
  // VK_INCOMPLETE only says that a device appeared in between.
  const VkResult result = vkEnumeratePhysicalDevices(instance, &count, devices.data());
  if (result != VK_INCOMPLETE) check(result, "vkEnumeratePhysicalDevices");
  devices.resize(count);
  std::vector<Probe> probes;
  for (uint32_t i = 0; i < count; ++i) probes.push_back(probeDevice(devices[i], i, options));
  return probes;
}

const Probe& chooseDevice(const std::vector<Probe>& probes, const std::string& choice) {
  const std::string wanted = lowered(choice);
  const bool isIndex = !wanted.empty() && std::ranges::all_of(wanted, [](char c) { return c >= '0' && c <= '9'; });
  const Probe* best = nullptr;
  for (const Probe& probe : probes) {
    const bool fits = wanted.empty()    ? true
                      : wanted == "cpu" ? probe.info.kind == "cpu"
                      : isIndex         ? wanted == std::to_string(probe.info.index)
                                        : lowered(probe.info.name).find(wanted) != std::string::npos;
    if (fits && (!best || rank(probe) > rank(*best))) best = &probe;
  }
  if (!best) {
    throw InputError(fmt::format("No Vulkan device fits \"{}\". There are:{}", choice, listing(probes)));
  }
  if (!best->info.missing.empty()) {
    throw InputError(fmt::format("{} cannot run Weir: it lacks {}. There are:{}", best->info.name,
                                 fmt::join(best->info.missing, ", "), listing(probes)));
  }
  return *best;
}

void requireSwapchain(const Probe& probe) {
  if (!extensionNames(probe.physical).contains(VK_KHR_SWAPCHAIN_EXTENSION_NAME))
    throw InputError(
        fmt::format("{} cannot show windows: it lacks {}", probe.info.name, VK_KHR_SWAPCHAIN_EXTENSION_NAME));
}

}  // namespace weir::gpu
