// Which Vulkan features Weir asks for. One line a feature: required ones are Weir's minimum.
#include <weir/gpu/probe.h>

namespace weir::gpu {

FeatureChain::FeatureChain(bool accelerationStructure, bool rayPipeline, bool rayQuery) {
  core.pNext = &v11;
  v11.pNext = &v12;
  v12.pNext = &v13;
  void** tail = &v13.pNext;
  const auto append = [&tail](auto& structure) {
    *tail = &structure;
    tail = &structure.pNext;
  };
  if (accelerationStructure) append(acceleration);
  if (rayPipeline) append(rayPipelines);
  if (rayQuery) append(rayQueries);
}

#define WEIR_FEATURE(required, part, field)                                              \
  {                                                                                      \
#field, required, [](FeatureChain & chain) -> VkBool32& { return chain.part.field; } \
  }

const std::vector<FeatureRule>& featureRules() {
  static const std::vector<FeatureRule> rules = {
      // Memory and addresses.
      WEIR_FEATURE(true, v12, bufferDeviceAddress),
      WEIR_FEATURE(true, v12, scalarBlockLayout),
      WEIR_FEATURE(true, core.features, shaderInt64),
      WEIR_FEATURE(false, core.features, shaderFloat64),
      WEIR_FEATURE(false, core.features, shaderInt16),
      WEIR_FEATURE(false, v12, shaderInt8),
      WEIR_FEATURE(false, v12, shaderFloat16),
      WEIR_FEATURE(false, v11, storageBuffer16BitAccess),
      WEIR_FEATURE(false, v12, storageBuffer8BitAccess),
      WEIR_FEATURE(false, v12, shaderBufferInt64Atomics),
      WEIR_FEATURE(false, v12, vulkanMemoryModel),
      WEIR_FEATURE(false, v12, vulkanMemoryModelDeviceScope),
      // Bindless textures.
      WEIR_FEATURE(true, v12, descriptorIndexing),
      WEIR_FEATURE(true, v12, runtimeDescriptorArray),
      WEIR_FEATURE(true, v12, shaderSampledImageArrayNonUniformIndexing),
      WEIR_FEATURE(true, v12, descriptorBindingPartiallyBound),
      WEIR_FEATURE(true, v12, descriptorBindingVariableDescriptorCount),
      WEIR_FEATURE(false, v12, descriptorBindingSampledImageUpdateAfterBind),
      WEIR_FEATURE(false, v12, shaderStorageBufferArrayNonUniformIndexing),
      WEIR_FEATURE(false, core.features, shaderSampledImageArrayDynamicIndexing),
      WEIR_FEATURE(false, core.features, shaderStorageBufferArrayDynamicIndexing),
      WEIR_FEATURE(false, core.features, shaderStorageImageArrayDynamicIndexing),
      WEIR_FEATURE(false, core.features, samplerAnisotropy),
      WEIR_FEATURE(false, core.features, textureCompressionBC),
      // Images that a pass reads and writes without naming their format in the shader.
      WEIR_FEATURE(true, core.features, shaderStorageImageReadWithoutFormat),
      WEIR_FEATURE(true, core.features, shaderStorageImageWriteWithoutFormat),
      WEIR_FEATURE(false, core.features, shaderStorageImageExtendedFormats),
      // Time and order.
      WEIR_FEATURE(true, v12, hostQueryReset),
      WEIR_FEATURE(true, v12, timelineSemaphore),
      WEIR_FEATURE(true, v13, synchronization2),
      WEIR_FEATURE(true, v13, maintenance4),
      // Shaders.
      WEIR_FEATURE(true, v13, shaderDemoteToHelperInvocation),
      WEIR_FEATURE(false, v13, subgroupSizeControl),
      WEIR_FEATURE(false, v13, computeFullSubgroups),
      // Rasterising. geometryShader is for gl_PrimitiveID in a fragment shader, which needs it.
      WEIR_FEATURE(true, v13, dynamicRendering),
      WEIR_FEATURE(false, core.features, fragmentStoresAndAtomics),
      WEIR_FEATURE(false, core.features, vertexPipelineStoresAndAtomics),
      WEIR_FEATURE(false, core.features, geometryShader),
      WEIR_FEATURE(false, core.features, independentBlend),
      WEIR_FEATURE(false, core.features, multiDrawIndirect),
      WEIR_FEATURE(false, core.features, drawIndirectFirstInstance),
      WEIR_FEATURE(false, v11, shaderDrawParameters),
      // Rays. Their structures are in the chain only where the device has the extension.
      WEIR_FEATURE(false, acceleration, accelerationStructure),
      WEIR_FEATURE(false, rayPipelines, rayTracingPipeline),
      WEIR_FEATURE(false, rayPipelines, rayTracingPipelineTraceRaysIndirect),
      WEIR_FEATURE(false, rayPipelines, rayTraversalPrimitiveCulling),
      WEIR_FEATURE(false, rayQueries, rayQuery),
  };
  return rules;
}

#undef WEIR_FEATURE

void wantFeatures(VkPhysicalDevice physical, const Capabilities& has, FeatureChain& chain) {
  FeatureChain supported(has.accelerationStructure, has.rayPipeline, has.rayQuery);
  vkGetPhysicalDeviceFeatures2(physical, &supported.core);
  for (const FeatureRule& rule : featureRules()) rule.field(chain) = rule.field(supported);
}

std::vector<const char*> deviceExtensions(const Capabilities& capabilities) {
  std::vector<const char*> names;
  if (capabilities.accelerationStructure) {
    names.push_back(VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME);
    names.push_back(VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME);
  }
  if (capabilities.rayPipeline) names.push_back(VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME);
  if (capabilities.rayQuery) names.push_back(VK_KHR_RAY_QUERY_EXTENSION_NAME);
  return names;
}

}  // namespace weir::gpu
