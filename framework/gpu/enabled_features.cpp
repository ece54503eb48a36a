// Reading what a host switched on: the same feature may stand in a structure of a Vulkan version or in that of the
// extension that it came from.
#include <weir/gpu/probe.h>

namespace weir::gpu {
namespace {

/// The structure's own head and pNext stay: only switches are taken over.
template <typename T>
void copyWhole(const VkBaseInStructure* from, T& to) {
  void* next = to.pNext;
  to = *reinterpret_cast<const T*>(from);
  to.pNext = next;
}

template <typename T>
const T& as(const VkBaseInStructure* s) {
  return *reinterpret_cast<const T*>(s);
}

/// Structures that Vulkan 1.2 and 1.3 gathered into one each.
void takeSingle12(const VkBaseInStructure* s, FeatureChain& c) {
  switch (s->sType) {
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_16BIT_STORAGE_FEATURES:
      c.v11.storageBuffer16BitAccess |= as<VkPhysicalDevice16BitStorageFeatures>(s).storageBuffer16BitAccess;
      break;
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_DRAW_PARAMETERS_FEATURES:
      c.v11.shaderDrawParameters |= as<VkPhysicalDeviceShaderDrawParametersFeatures>(s).shaderDrawParameters;
      break;
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_BUFFER_DEVICE_ADDRESS_FEATURES:
      c.v12.bufferDeviceAddress |= as<VkPhysicalDeviceBufferDeviceAddressFeatures>(s).bufferDeviceAddress;
      break;
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SCALAR_BLOCK_LAYOUT_FEATURES:
      c.v12.scalarBlockLayout |= as<VkPhysicalDeviceScalarBlockLayoutFeatures>(s).scalarBlockLayout;
      break;
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_FLOAT16_INT8_FEATURES:
      c.v12.shaderFloat16 |= as<VkPhysicalDeviceShaderFloat16Int8Features>(s).shaderFloat16;
      c.v12.shaderInt8 |= as<VkPhysicalDeviceShaderFloat16Int8Features>(s).shaderInt8;
      break;
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_8BIT_STORAGE_FEATURES:
      c.v12.storageBuffer8BitAccess |= as<VkPhysicalDevice8BitStorageFeatures>(s).storageBuffer8BitAccess;
      break;
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_ATOMIC_INT64_FEATURES:
      c.v12.shaderBufferInt64Atomics |= as<VkPhysicalDeviceShaderAtomicInt64Features>(s).shaderBufferInt64Atomics;
      break;
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_MEMORY_MODEL_FEATURES: {
      const auto& model = as<VkPhysicalDeviceVulkanMemoryModelFeatures>(s);
      c.v12.vulkanMemoryModel |= model.vulkanMemoryModel;
      c.v12.vulkanMemoryModelDeviceScope |= model.vulkanMemoryModelDeviceScope;
      break;
    }
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DESCRIPTOR_INDEXING_FEATURES: {
      const auto& indexing = as<VkPhysicalDeviceDescriptorIndexingFeatures>(s);
      c.v12.descriptorIndexing = VK_TRUE;  // the structure itself stands for it
      c.v12.runtimeDescriptorArray |= indexing.runtimeDescriptorArray;
      c.v12.shaderSampledImageArrayNonUniformIndexing |= indexing.shaderSampledImageArrayNonUniformIndexing;
      c.v12.shaderStorageBufferArrayNonUniformIndexing |= indexing.shaderStorageBufferArrayNonUniformIndexing;
      c.v12.descriptorBindingPartiallyBound |= indexing.descriptorBindingPartiallyBound;
      c.v12.descriptorBindingVariableDescriptorCount |= indexing.descriptorBindingVariableDescriptorCount;
      c.v12.descriptorBindingSampledImageUpdateAfterBind |= indexing.descriptorBindingSampledImageUpdateAfterBind;
      break;
    }
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_HOST_QUERY_RESET_FEATURES:
      c.v12.hostQueryReset |= as<VkPhysicalDeviceHostQueryResetFeatures>(s).hostQueryReset;
      break;
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_TIMELINE_SEMAPHORE_FEATURES:
      c.v12.timelineSemaphore |= as<VkPhysicalDeviceTimelineSemaphoreFeatures>(s).timelineSemaphore;
      break;
    default:
      break;
  }
}

void takeSingle13(const VkBaseInStructure* s, FeatureChain& c) {
  switch (s->sType) {
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SYNCHRONIZATION_2_FEATURES:
      c.v13.synchronization2 |= as<VkPhysicalDeviceSynchronization2Features>(s).synchronization2;
      break;
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_4_FEATURES:
      c.v13.maintenance4 |= as<VkPhysicalDeviceMaintenance4Features>(s).maintenance4;
      break;
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_DEMOTE_TO_HELPER_INVOCATION_FEATURES:
      c.v13.shaderDemoteToHelperInvocation |=
          as<VkPhysicalDeviceShaderDemoteToHelperInvocationFeatures>(s).shaderDemoteToHelperInvocation;
      break;
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_SIZE_CONTROL_FEATURES: {
      const auto& control = as<VkPhysicalDeviceSubgroupSizeControlFeatures>(s);
      c.v13.subgroupSizeControl |= control.subgroupSizeControl;
      c.v13.computeFullSubgroups |= control.computeFullSubgroups;
      break;
    }
    case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DYNAMIC_RENDERING_FEATURES:
      c.v13.dynamicRendering |= as<VkPhysicalDeviceDynamicRenderingFeatures>(s).dynamicRendering;
      break;
    default:
      break;
  }
}

}  // namespace

void takeEnabled(const VkPhysicalDeviceFeatures2* enabled, FeatureChain& c) {
  for (const auto* s = reinterpret_cast<const VkBaseInStructure*>(enabled); s != nullptr; s = s->pNext) {
    switch (s->sType) {
      case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2:
        copyWhole(s, c.core);
        break;
      case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES:
        copyWhole(s, c.v11);
        break;
      case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES:
        copyWhole(s, c.v12);
        break;
      case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES:
        copyWhole(s, c.v13);
        break;
      case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR:
        copyWhole(s, c.acceleration);
        break;
      case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_FEATURES_KHR:
        copyWhole(s, c.rayPipelines);
        break;
      case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR:
        copyWhole(s, c.rayQueries);
        break;
      default:
        takeSingle12(s, c);
        takeSingle13(s, c);
    }
  }
}

}  // namespace weir::gpu
