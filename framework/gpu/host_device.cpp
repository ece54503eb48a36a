// A device that somebody else made: what it was made with, and what it should be made with.
#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/gpu/probe.h>

#include <algorithm>

namespace weir::gpu {
namespace {

bool named(const std::vector<std::string>& names, const char* name) {
  return std::ranges::find(names, name) != names.end();
}

/// The queue family that the host chose, instead of the one that Weir would have taken.
void readQueueFamily(const HostDevice& host, DeviceInfo& info) {
  uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(host.physical, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(host.physical, &count, families.data());
  if (host.queueFamily >= count) {
    info.missing.push_back(fmt::format("queue family {} (it has {})", host.queueFamily, count));
    return;
  }
  const VkQueueFamilyProperties& family = families[host.queueFamily];
  if ((family.queueFlags & VK_QUEUE_COMPUTE_BIT) == 0)
    info.missing.push_back(fmt::format("a queue that computes (family {} does not)", host.queueFamily));
  info.capabilities.graphics = (family.queueFlags & VK_QUEUE_GRAPHICS_BIT) != 0;
  if (!info.capabilities.graphics)
    info.missingForRaster.push_back(fmt::format("a queue that draws (family {} does not)", host.queueFamily));
  if (family.timestampValidBits == 0) info.capabilities.timestampPeriod = 0.0f;
}

void readRays(const HostDevice& host, FeatureChain& chain, DeviceInfo& info) {
  std::vector<std::string>& missing = info.missingForRays;
  bool structures = true;
  const auto need = [&](bool there, const char* name) {
    if (!there) missing.emplace_back(name);
    structures &= there;
  };
  need(named(host.extensions, VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME),
       VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME);
  need(named(host.extensions, VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME),
       VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME);
  need(chain.acceleration.accelerationStructure, "accelerationStructure");
  Capabilities& has = info.capabilities;
  has.accelerationStructure &= structures;
  has.rayPipeline &= structures && named(host.extensions, VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME) &&
                     chain.rayPipelines.rayTracingPipeline;
  has.rayQuery &= structures && named(host.extensions, VK_KHR_RAY_QUERY_EXTENSION_NAME) && chain.rayQueries.rayQuery;
  if (!has.rayPipeline && !has.rayQuery)
    missing.emplace_back("VK_KHR_ray_query with rayQuery, or VK_KHR_ray_tracing_pipeline with rayTracingPipeline");
}

}  // namespace

DeviceInfo inspect(const HostDevice& host) {
  if (host.instance == VK_NULL_HANDLE || host.physical == VK_NULL_HANDLE)
    throw InputError("the host's instance and physical device must be given");
  loadVulkan(host.loader);
  DeviceInfo info = probeDevice(host.physical, 0, {}).info;
  info.missing.clear();
  readQueueFamily(host, info);
  if (host.apiVersion < VK_API_VERSION_1_3)
    info.missing.push_back(
        fmt::format("an instance for Vulkan 1.3 (the host's is for {})", versionText(host.apiVersion)));
  if (info.apiVersion < VK_API_VERSION_1_3) {
    info.missing.push_back(fmt::format("Vulkan 1.3 (it has {})", versionText(info.apiVersion)));
    info.capabilities.accelerationStructure = info.capabilities.rayPipeline = info.capabilities.rayQuery = false;
    return info;
  }
  FeatureChain chain(true, true, true);
  takeEnabled(host.features, chain);
  for (const FeatureRule& rule : featureRules())
    if (rule.required && !rule.field(chain)) info.missing.emplace_back(rule.name);
  info.capabilities.doubles = chain.core.features.shaderFloat64;
  readRays(host, chain, info);
  return info;
}

struct HostNeeds::Chain {
  FeatureChain features;
  explicit Chain(const Capabilities& has) : features(has.accelerationStructure, has.rayPipeline, has.rayQuery) {}
};

HostNeeds::HostNeeds(const HostDevice& host) {
  if (host.instance == VK_NULL_HANDLE || host.physical == VK_NULL_HANDLE)
    throw InputError("the host's instance and physical device must be given");
  loadVulkan(host.loader);
  info_ = probeDevice(host.physical, 0, {}).info;
  const bool recent = info_.apiVersion >= VK_API_VERSION_1_3;
  chain_ = std::make_unique<Chain>(info_.capabilities);
  if (recent) wantFeatures(host.physical, info_.capabilities, chain_->features);
  extensions_ = deviceExtensions(info_.capabilities);
}

HostNeeds::~HostNeeds() = default;

VkPhysicalDeviceFeatures2* HostNeeds::features() {
  return &chain_->features.core;
}

}  // namespace weir::gpu
