#include <weir/execute/pipelines.h>
#include <weir/execute/prelude.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

namespace weir::execute {
namespace {

/// A shader module that lives while its pipeline is made.
class Shader {
 public:
  Shader(const gpu::Device& device, std::span<const uint32_t> spirv) : device_(device) {
    VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    info.codeSize = spirv.size_bytes();
    info.pCode = spirv.data();
    gpu::check(vkCreateShaderModule(device.handle(), &info, nullptr, &module_), "vkCreateShaderModule");
  }
  ~Shader() { vkDestroyShaderModule(device_.handle(), module_, nullptr); }
  Shader(const Shader&) = delete;
  Shader& operator=(const Shader&) = delete;
  VkPipelineShaderStageCreateInfo stage(VkShaderStageFlagBits bit, const VkSpecializationInfo* constants) const {
    VkPipelineShaderStageCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
    info.stage = bit;
    info.module = module_;
    info.pName = "main";
    info.pSpecializationInfo = constants;
    return info;
  }

 private:
  const gpu::Device& device_;
  VkShaderModule module_ = VK_NULL_HANDLE;
};

/// VkSpecializationInfo over a list of 32-bit values; keep it alive while it is used.
struct SpecializationInfo {
  explicit SpecializationInfo(const Specialization& values) : entries(values.size()) {
    for (uint32_t i = 0; i < entries.size(); ++i) entries[i] = {i, i * 4, 4};
    info = {static_cast<uint32_t>(entries.size()), entries.data(), values.size() * 4, values.data()};
  }
  std::vector<VkSpecializationMapEntry> entries;
  VkSpecializationInfo info{};
};

uint64_t alignUp(uint64_t value, uint64_t alignment) {
  return (value + alignment - 1) / alignment * alignment;
}

VkRayTracingShaderGroupCreateInfoKHR group(VkRayTracingShaderGroupTypeKHR type) {
  VkRayTracingShaderGroupCreateInfoKHR g{VK_STRUCTURE_TYPE_RAY_TRACING_SHADER_GROUP_CREATE_INFO_KHR};
  g.type = type;
  g.generalShader = g.closestHitShader = g.anyHitShader = g.intersectionShader = VK_SHADER_UNUSED_KHR;
  return g;
}

}  // namespace

Pipeline::~Pipeline() {
  if (device_ != nullptr) vkDestroyPipeline(device_->handle(), pipeline_, nullptr);
}

Pipeline::Pipeline(Pipeline&& other) noexcept
    : device_(std::exchange(other.device_, nullptr)),
      pipeline_(std::exchange(other.pipeline_, VK_NULL_HANDLE)),
      bindPoint_(other.bindPoint_),
      groupSide_(other.groupSide_),
      table_(std::move(other.table_)),
      generation_(other.generation_),
      miss_(other.miss_),
      hit_(other.hit_),
      callable_(other.callable_) {}

Pipeline& Pipeline::operator=(Pipeline&& other) noexcept {
  std::swap(device_, other.device_);
  std::swap(pipeline_, other.pipeline_);
  std::swap(table_, other.table_);
  bindPoint_ = other.bindPoint_;
  groupSide_ = other.groupSide_;
  generation_ = other.generation_;
  miss_ = other.miss_;
  hit_ = other.hit_;
  callable_ = other.callable_;
  return *this;
}

VkPipelineStageFlags2 vulkanStages(graph::Stages stages) {
  VkPipelineStageFlags2 result = 0;
  if ((stages & graph::kComputeStage) != 0) result |= VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
  if ((stages & graph::kRayStage) != 0) result |= VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR;
  if ((stages & graph::kRasterStage) != 0)
    result |= VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT |
              VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT |
              VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT;
  return result;
}

VkAccessFlags2 writeAccess(graph::Stages stages) {
  const bool raster = (stages & graph::kRasterStage) != 0;
  return VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT |
         (raster ? VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT : 0);
}

VkAccessFlags2 readAccess(graph::Stages stages) {
  const bool raster = (stages & graph::kRasterStage) != 0;
  return VK_ACCESS_2_SHADER_STORAGE_READ_BIT |
         (raster ? VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT : 0);
}

graph::Stages Pipeline::stages() const {
  switch (bindPoint_) {
    case VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR:
      return graph::kRayStage;
    case VK_PIPELINE_BIND_POINT_GRAPHICS:
      return graph::kRasterStage;
    default:
      return graph::kComputeStage;
  }
}

Pipeline Pipeline::compute(const gpu::Device& device, VkPipelineLayout layout, std::span<const uint32_t> spirv,
                           const Specialization& constants, uint32_t groupSide, const std::string& name) {
  const Shader shader(device, spirv);
  const SpecializationInfo special(constants);
  VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
  info.stage = shader.stage(VK_SHADER_STAGE_COMPUTE_BIT, &special.info);
  info.layout = layout;
  Pipeline p;
  p.device_ = &device;
  p.groupSide_ = groupSide;
  gpu::check(vkCreateComputePipelines(device.handle(), device.pipelineCache(), 1, &info, nullptr, &p.pipeline_),
             "vkCreateComputePipelines");
  device.name(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<uint64_t>(p.pipeline_), name);
  return p;
}

Pipeline Pipeline::rays(const gpu::Device& device, VkPipelineLayout layout, std::span<const uint32_t> rayGeneration,
                        const HitShaders& hits, const Specialization& constants, const std::string& name) {
  const Shader generation(device, rayGeneration), closest(device, hits.closestHit),
      closestAny(device, hits.closestAnyHit), closestMiss(device, hits.closestMiss),
      shadowAny(device, hits.shadowAnyHit), shadowMiss(device, hits.shadowMiss);
  const SpecializationInfo special(constants);
  const std::array stages = {generation.stage(VK_SHADER_STAGE_RAYGEN_BIT_KHR, &special.info),
                             closestMiss.stage(VK_SHADER_STAGE_MISS_BIT_KHR, nullptr),
                             shadowMiss.stage(VK_SHADER_STAGE_MISS_BIT_KHR, nullptr),
                             closest.stage(VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, nullptr),
                             closestAny.stage(VK_SHADER_STAGE_ANY_HIT_BIT_KHR, nullptr),
                             shadowAny.stage(VK_SHADER_STAGE_ANY_HIT_BIT_KHR, nullptr)};
  // Groups: generation, two misses, two hit groups (primary, shadow), in the order of the table.
  std::array<VkRayTracingShaderGroupCreateInfoKHR, 5> groups;
  for (uint32_t i = 0; i < 3; ++i) {
    groups[i] = group(VK_RAY_TRACING_SHADER_GROUP_TYPE_GENERAL_KHR);
    groups[i].generalShader = i;
  }
  groups[3] = group(VK_RAY_TRACING_SHADER_GROUP_TYPE_TRIANGLES_HIT_GROUP_KHR);
  groups[3].closestHitShader = 3;
  groups[3].anyHitShader = 4;
  groups[4] = group(VK_RAY_TRACING_SHADER_GROUP_TYPE_TRIANGLES_HIT_GROUP_KHR);
  groups[4].anyHitShader = 5;

  VkRayTracingPipelineCreateInfoKHR info{VK_STRUCTURE_TYPE_RAY_TRACING_PIPELINE_CREATE_INFO_KHR};
  info.stageCount = static_cast<uint32_t>(stages.size());
  info.pStages = stages.data();
  info.groupCount = static_cast<uint32_t>(groups.size());
  info.pGroups = groups.data();
  info.maxPipelineRayRecursionDepth = 1;
  info.layout = layout;
  Pipeline p;
  p.device_ = &device;
  p.bindPoint_ = VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR;
  gpu::check(vkCreateRayTracingPipelinesKHR(device.handle(), VK_NULL_HANDLE, device.pipelineCache(), 1, &info, nullptr,
                                            &p.pipeline_),
             "vkCreateRayTracingPipelinesKHR");
  device.name(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<uint64_t>(p.pipeline_), name);

  const gpu::Capabilities& has = device.capabilities();
  const uint64_t handle = has.shaderGroupHandleSize;
  const uint64_t stride = alignUp(handle, has.shaderGroupHandleAlignment);
  const uint64_t base = has.shaderGroupBaseAlignment;
  std::vector<std::byte> handles(groups.size() * handle);
  gpu::check(vkGetRayTracingShaderGroupHandlesKHR(device.handle(), p.pipeline_, 0, static_cast<uint32_t>(groups.size()),
                                                  handles.size(), handles.data()),
             "vkGetRayTracingShaderGroupHandlesKHR");
  const uint64_t missStart = alignUp(stride, base), hitStart = alignUp(missStart + 2 * stride, base);
  std::vector<std::byte> table(hitStart + 2 * stride);
  const std::array<uint64_t, 5> places = {0, missStart, missStart + stride, hitStart, hitStart + stride};
  for (size_t i = 0; i < places.size(); ++i) std::memcpy(&table[places[i]], &handles[i * handle], handle);
  p.table_ = gpu::uploadBuffer(device, table,
                               VK_BUFFER_USAGE_SHADER_BINDING_TABLE_BIT_KHR | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                               name + " binding table");
  const VkDeviceAddress address = p.table_.address();
  p.generation_ = {address, stride, stride};
  p.miss_ = {address + missStart, stride, 2 * stride};
  p.hit_ = {address + hitStart, stride, 2 * stride};
  return p;
}

Pipeline Pipeline::raster(const gpu::Device& device, VkPipelineLayout layout, std::span<const uint32_t> vertex,
                          std::span<const uint32_t> fragment, VkFormat format, const Specialization& constants,
                          const std::string& name) {
  const Shader vertexShader(device, vertex), fragmentShader(device, fragment);
  const SpecializationInfo special(constants);
  const std::array stages = {vertexShader.stage(VK_SHADER_STAGE_VERTEX_BIT, &special.info),
                             fragmentShader.stage(VK_SHADER_STAGE_FRAGMENT_BIT, &special.info)};
  const VkPipelineVertexInputStateCreateInfo input{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
  VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
  viewport.viewportCount = viewport.scissorCount = 1;
  VkPipelineRasterizationStateCreateInfo raster{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
  raster.polygonMode = VK_POLYGON_MODE_FILL;
  raster.lineWidth = 1.0f;
  VkPipelineMultisampleStateCreateInfo samples{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
  samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
  VkPipelineDepthStencilStateCreateInfo depth{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
  depth.depthTestEnable = depth.depthWriteEnable = VK_TRUE;
  depth.depthCompareOp = VK_COMPARE_OP_GREATER;
  VkPipelineColorBlendAttachmentState attachment{};
  attachment.colorWriteMask = VK_COLOR_COMPONENT_R_BIT;
  VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
  blend.attachmentCount = 1;
  blend.pAttachments = &attachment;
  const std::array dynamicStates = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR, VK_DYNAMIC_STATE_CULL_MODE,
                                    VK_DYNAMIC_STATE_FRONT_FACE};
  VkPipelineDynamicStateCreateInfo dynamic{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
  dynamic.dynamicStateCount = static_cast<uint32_t>(dynamicStates.size());
  dynamic.pDynamicStates = dynamicStates.data();
  VkPipelineRenderingCreateInfo rendering{VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO};
  rendering.colorAttachmentCount = 1;
  rendering.pColorAttachmentFormats = &format;
  rendering.depthAttachmentFormat = VK_FORMAT_D32_SFLOAT;

  VkGraphicsPipelineCreateInfo info{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO};
  info.pNext = &rendering;
  info.stageCount = static_cast<uint32_t>(stages.size());
  info.pStages = stages.data();
  info.pVertexInputState = &input;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &viewport;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &samples;
  info.pDepthStencilState = &depth;
  info.pColorBlendState = &blend;
  info.pDynamicState = &dynamic;
  info.layout = layout;
  Pipeline p;
  p.device_ = &device;
  p.bindPoint_ = VK_PIPELINE_BIND_POINT_GRAPHICS;
  gpu::check(vkCreateGraphicsPipelines(device.handle(), device.pipelineCache(), 1, &info, nullptr, &p.pipeline_),
             "vkCreateGraphicsPipelines");
  device.name(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<uint64_t>(p.pipeline_), name);
  return p;
}

void Pipeline::launch(VkCommandBuffer commands, uint32_t width, uint32_t height) const {
  if (bindPoint_ == VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR) {
    vkCmdTraceRaysKHR(commands, &generation_, &miss_, &hit_, &callable_, width, height, 1);
  } else if (groupSide_ == 0) {
    // No dimension may have more groups than this on every device.
    const uint32_t groups = (width + kRowGroup - 1) / kRowGroup, most = 65535;
    vkCmdDispatch(commands, std::min(groups, most), (groups + most - 1) / most, 1);
  } else {
    vkCmdDispatch(commands, (width + groupSide_ - 1) / groupSide_, (height + groupSide_ - 1) / groupSide_, 1);
  }
}

}  // namespace weir::execute
