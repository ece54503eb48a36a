// Loading Vulkan and creating instances.
#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/gpu/probe.h>

#include <atomic>
#include <cstring>
#include <mutex>

namespace weir::gpu {
namespace {

std::atomic<bool> debugUtils{false};

bool layerInstalled(const char* name) {
  uint32_t count = 0;
  vkEnumerateInstanceLayerProperties(&count, nullptr);
  std::vector<VkLayerProperties> layers(count);
  vkEnumerateInstanceLayerProperties(&count, layers.data());
  for (const VkLayerProperties& layer : layers) {
    if (std::strcmp(layer.layerName, name) == 0) return true;
  }
  return false;
}

bool instanceExtensionAvailable(const char* name) {
  uint32_t count = 0;
  vkEnumerateInstanceExtensionProperties(nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> extensions(count);
  vkEnumerateInstanceExtensionProperties(nullptr, &count, extensions.data());
  for (const VkExtensionProperties& extension : extensions) {
    if (std::strcmp(extension.extensionName, name) == 0) return true;
  }
  return false;
}

/// volk's loader keeps its state in globals, so once per process; a failure is remembered, not retried.
void loadVulkanLibrary(PFN_vkGetInstanceProcAddr loader) {
  static std::once_flag once;
  static VkResult result = VK_SUCCESS;
  std::call_once(once, [loader] {
    if (loader != nullptr)
      volkInitializeCustom(loader);
    else
      result = volkInitialize();
  });
  if (result != VK_SUCCESS) {
    throw RuntimeError("There is no Vulkan on this machine: libvulkan.so.1 cannot be loaded (Debian: libvulkan1).");
  }
}

/// Function pointers come from the first instance and serve every later one: the loader hands out trampolines that find
/// the driver by the handle they are called with. volkLoadDevice would tie them to one device's driver instead, and
/// loading them again for each instance would write to globals that other threads are calling through.
std::once_flag functionsOnce;
void loadFunctions(VkInstance instance) {
  std::call_once(functionsOnce, [instance] { volkLoadInstance(instance); });
}

}  // namespace

bool hasDebugUtils() {
  return debugUtils;
}

void loadVulkan(PFN_vkGetInstanceProcAddr loader) {
  loadVulkanLibrary(loader);
  // Asked for what needs no instance, two ways into one loader give the same address.
  if (loader != nullptr && loader(nullptr, "vkCreateInstance") != vkGetInstanceProcAddr(nullptr, "vkCreateInstance"))
    throw RuntimeError(
        "the host's vkGetInstanceProcAddr belongs to another Vulkan loader than the one this process uses Weir with");
  // The host's instance may lack extensions that a later one has, and pointers are fetched only once: so they come from
  // an instance of Weir's own, which has them all and need not stay.
  static std::mutex mutex;
  static bool loaded = false;
  const std::lock_guard lock(mutex);
  if (loaded) return;
  const VkInstance instance = createInstance(false, nullptr);  // fills in vkDestroyInstance, too
  vkDestroyInstance(instance, nullptr);
  loaded = true;
}

VkInstance createInstance(bool validation, const VkDebugUtilsMessengerCreateInfoEXT* messages,
                          const std::vector<std::string>& wanted) {
  loadVulkanLibrary(nullptr);
  static constexpr const char* kLayer = "VK_LAYER_KHRONOS_validation";
  if (validation && !layerInstalled(kLayer)) {
    throw InputError(
        fmt::format("Validation was asked for, but {} is not installed (Debian: vulkan-validationlayers).", kLayer));
  }
  if (volkGetInstanceVersion() < VK_API_VERSION_1_3) {
    throw RuntimeError(
        fmt::format("The Vulkan loader is version {}, and Weir needs 1.3.", versionText(volkGetInstanceVersion())));
  }
  // Every instance of a process has the same extensions, so that the shared function pointers suit them all; a window's
  // are wanted by the first one or not at all.
  std::vector<const char*> extensions;
  for (const std::string& name : wanted) {
    if (!instanceExtensionAvailable(name.c_str()))
      throw InputError(fmt::format("There can be no window: Vulkan on this machine lacks {}.", name));
    extensions.push_back(name.c_str());
  }
  const bool utils = instanceExtensionAvailable(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  if (utils) extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  debugUtils = utils;

  const VkApplicationInfo application{
      .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .pApplicationName = "weir", .apiVersion = VK_API_VERSION_1_3};
  const VkValidationFeatureEnableEXT enabled[] = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
  const VkValidationFeaturesEXT features{.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                         .pNext = utils ? messages : nullptr,
                                         .enabledValidationFeatureCount = 1,
                                         .pEnabledValidationFeatures = enabled};
  if (validation) extensions.push_back(VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME);
  const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                  .pNext = validation ? &features : nullptr,
                                  .pApplicationInfo = &application,
                                  .enabledLayerCount = validation ? 1u : 0u,
                                  .ppEnabledLayerNames = &kLayer,
                                  .enabledExtensionCount = static_cast<uint32_t>(extensions.size()),
                                  .ppEnabledExtensionNames = extensions.data()};
  VkInstance instance = VK_NULL_HANDLE;
  const VkResult result = vkCreateInstance(&info, nullptr, &instance);
  if (result == VK_ERROR_INCOMPATIBLE_DRIVER) {
    throw RuntimeError(
        "There is no Vulkan driver on this machine that can be loaded (Debian: mesa-vulkan-drivers has one for the "
        "CPU). "
        "VK_LOADER_DEBUG=error says which were tried.");
  }
  check(result, "vkCreateInstance");
  loadFunctions(instance);
  return instance;
}

std::string versionText(uint32_t version) {
  return fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(version), VK_API_VERSION_MINOR(version),
                     VK_API_VERSION_PATCH(version));
}

}  // namespace weir::gpu
