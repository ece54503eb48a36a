#include <weir/core/paths.h>
#include <weir/execute/light_table.h>
#include <weir/gpu/barrier.h>

#include <algorithm>
#include <bit>
#include <string>

namespace weir::execute {
namespace {

/// As shaders/common/light_table.glsl has them.
constexpr uint32_t kThreads = 256, kGroup = kThreads * 8, kMostGroups = 65535;
constexpr uint64_t kSumBytes = 8, kPartBytes = 32, kStepBytes = 8, kOrderBytes = 4;
struct Push {
  uint32_t count, groups, shift, pdfStride, pdfOffset;
};

/// Bits behind the point of sums over so many cells: they stay below 2⁶³, and a unit is less than a light's rounding.
uint32_t shiftFor(uint32_t lights) {
  return std::min(42u, 62u - static_cast<uint32_t>(std::bit_width(lights)));
}

void dispatch(VkCommandBuffer commands, uint32_t groups) {
  vkCmdDispatch(commands, std::min(groups, kMostGroups), (groups + kMostGroups - 1) / kMostGroups, 1);
}

}  // namespace

bool LightTable::supported(const gpu::Device& device) {
  return device.capabilities().doubles;
}

LightTable::LightTable(const gpu::Device& device, shader::Compiler& compiler, uint32_t lights, VkBuffer powers,
                       VkBuffer cells, const std::vector<LightProbabilities>& probabilities)
    : device_(device), lights_(lights), groups_((lights + kGroup - 1) / kGroup), probabilities_(probabilities) {
  const auto buffer = [&](uint64_t bytes, const char* name) {
    return gpu::Buffer(device, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Residency::Device, name);
  };
  sums_ = buffer(kSumBytes * (groups_ + 1), "light table sums");
  parts_ = buffer(kPartBytes * (groups_ + 1), "light table parts");
  steps_ = buffer(kStepBytes * lights, "light table steps");
  order_ = buffer(kOrderBytes * lights, "light table order");
  makeLayouts(static_cast<uint32_t>(probabilities_.size()));
  for (uint32_t stage = 0; stage < kStages; ++stage) {
    shader::CompileRequest request;
    request.name = "light_table.glsl";
    request.source = "#version 460\n#define STAGE " + std::to_string(stage) + "\n#include \"light_table.glsl\"\n";
    request.stage = shader::Stage::Compute;
    request.includeFolders.push_back(commonShaderFolder().string());
    kernels_[stage] = Pipeline::compute(device, pipelineLayout_, compiler.compile(request).spirv, {}, 8,
                                        "light table " + std::to_string(stage));
  }
  for (size_t i = 0; i < sets_.size(); ++i) {
    makeSet(sets_[i], {powers, cells, probabilities_[i].buffer, sums_.handle(), parts_.handle(), steps_.handle(),
                       order_.handle()});
  }
}

LightTable::~LightTable() {
  vkDestroyDescriptorPool(device_.handle(), pool_, nullptr);
  vkDestroyPipelineLayout(device_.handle(), pipelineLayout_, nullptr);
  vkDestroyDescriptorSetLayout(device_.handle(), setLayout_, nullptr);
}

void LightTable::makeLayouts(uint32_t sets) {
  std::array<VkDescriptorSetLayoutBinding, 7> bindings{};
  for (uint32_t b = 0; b < bindings.size(); ++b)
    bindings[b] = {b, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr};
  VkDescriptorSetLayoutCreateInfo layout{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  layout.bindingCount = static_cast<uint32_t>(bindings.size());
  layout.pBindings = bindings.data();
  gpu::check(vkCreateDescriptorSetLayout(device_.handle(), &layout, nullptr, &setLayout_),
             "vkCreateDescriptorSetLayout");
  const VkPushConstantRange range{VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(Push)};
  VkPipelineLayoutCreateInfo pipeline{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  pipeline.setLayoutCount = 1;
  pipeline.pSetLayouts = &setLayout_;
  pipeline.pushConstantRangeCount = 1;
  pipeline.pPushConstantRanges = &range;
  gpu::check(vkCreatePipelineLayout(device_.handle(), &pipeline, nullptr, &pipelineLayout_), "vkCreatePipelineLayout");
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, static_cast<uint32_t>(bindings.size()) * sets};
  VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  pool.maxSets = sets;
  pool.poolSizeCount = 1;
  pool.pPoolSizes = &size;
  gpu::check(vkCreateDescriptorPool(device_.handle(), &pool, nullptr, &pool_), "vkCreateDescriptorPool");
  const std::vector<VkDescriptorSetLayout> layouts(sets, setLayout_);
  VkDescriptorSetAllocateInfo allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  allocate.descriptorPool = pool_;
  allocate.descriptorSetCount = sets;
  allocate.pSetLayouts = layouts.data();
  sets_.resize(sets);
  gpu::check(vkAllocateDescriptorSets(device_.handle(), &allocate, sets_.data()), "vkAllocateDescriptorSets");
}

void LightTable::makeSet(VkDescriptorSet set, const std::array<VkBuffer, 7>& buffers) const {
  std::array<VkDescriptorBufferInfo, 7> infos{};
  std::array<VkWriteDescriptorSet, 7> writes{};
  for (uint32_t b = 0; b < buffers.size(); ++b) {
    infos[b] = {buffers[b], 0, VK_WHOLE_SIZE};
    writes[b].sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
    writes[b].dstSet = set;
    writes[b].dstBinding = b;
    writes[b].descriptorCount = 1;
    writes[b].descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    writes[b].pBufferInfo = &infos[b];
  }
  vkUpdateDescriptorSets(device_.handle(), static_cast<uint32_t>(writes.size()), writes.data(), 0, nullptr);
}

void LightTable::record(VkCommandBuffer commands, uint32_t probabilities) const {
  const LightProbabilities& to = probabilities_[probabilities];
  const Push push{lights_, groups_, shiftFor(lights_), to.stride, to.offset};
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipelineLayout_, 0, 1, &sets_[probabilities], 0,
                          nullptr);
  vkCmdPushConstants(commands, pipelineLayout_, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, &push);
  const std::array<uint32_t, kStages> groups = {groups_, 1, groups_, 1, groups_, (lights_ + kThreads - 1) / kThreads};
  for (uint32_t stage = 0; stage < kStages; ++stage) {
    if (stage > 0)
      gpu::memoryBarrier(commands, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_WRITE_BIT,
                         VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                         VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_SHADER_WRITE_BIT);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, kernels_[stage].handle());
    dispatch(commands, groups[stage]);
  }
}

uint64_t LightTable::bytes() const {
  return sums_.size() + parts_.size() + steps_.size() + order_.size();
}

}  // namespace weir::execute
