#include <weir/core/error.h>
#include <weir/core/paths.h>
#include <weir/execute/tool_kernel.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace weir::execute {

ToolKernel::ToolKernel(const gpu::Device& device, shader::Compiler& compiler, const ToolKernelOptions& options)
    : device_(device), images_(options.images), pushBytes_(options.pushBytes) {
  shader::CompileRequest request;
  request.name = options.file;
  request.source = shader::readFile(options.file);
  request.stage = shader::Stage::Compute;
  request.includeFolders = options.includeFolders;
  request.includeFolders.push_back(commonShaderFolder().string());
  request.defines = options.defines;
  const shader::Module module = compiler.compile(request);
  files_ = module.files;
  files_.push_back(options.file);
  try {
    makeLayouts(options);
    pipeline_ = Pipeline::compute(device, layout_, module.spirv, {}, options.groupSide, options.name);
  } catch (...) {
    destroy();
    throw;
  }
}

ToolKernel::~ToolKernel() {
  destroy();
}

void ToolKernel::destroy() noexcept {
  vkDestroyDescriptorPool(device_.handle(), pool_, nullptr);
  vkDestroyPipelineLayout(device_.handle(), layout_, nullptr);
  vkDestroyDescriptorSetLayout(device_.handle(), setLayout_, nullptr);
}

void ToolKernel::makeLayouts(const ToolKernelOptions& options) {
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  for (uint32_t b = 0; b < images_.size(); ++b)
    bindings.push_back({b, images_[b] ? VK_DESCRIPTOR_TYPE_STORAGE_IMAGE : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1,
                        VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
  VkDescriptorSetLayoutCreateInfo set{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  set.bindingCount = static_cast<uint32_t>(bindings.size());
  set.pBindings = bindings.data();
  gpu::check(vkCreateDescriptorSetLayout(device_.handle(), &set, nullptr, &setLayout_), "vkCreateDescriptorSetLayout");
  const VkPushConstantRange range{VK_SHADER_STAGE_COMPUTE_BIT, 0, pushBytes_};
  VkPipelineLayoutCreateInfo layout{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  layout.setLayoutCount = 1;
  layout.pSetLayouts = &setLayout_;
  layout.pushConstantRangeCount = pushBytes_ > 0 ? 1 : 0;
  layout.pPushConstantRanges = &range;
  gpu::check(vkCreatePipelineLayout(device_.handle(), &layout, nullptr, &layout_), "vkCreatePipelineLayout");

  const auto count = static_cast<uint32_t>(images_.size());
  const auto images = static_cast<uint32_t>(std::ranges::count(images_, true));
  std::vector<VkDescriptorPoolSize> sizes;
  if (images > 0) sizes.push_back({VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, images * options.sets});
  if (count > images) sizes.push_back({VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, (count - images) * options.sets});
  VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  pool.maxSets = options.sets;
  pool.poolSizeCount = static_cast<uint32_t>(sizes.size());
  pool.pPoolSizes = sizes.data();
  gpu::check(vkCreateDescriptorPool(device_.handle(), &pool, nullptr, &pool_), "vkCreateDescriptorPool");
  const std::vector<VkDescriptorSetLayout> layouts(options.sets, setLayout_);
  VkDescriptorSetAllocateInfo allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  allocate.descriptorPool = pool_;
  allocate.descriptorSetCount = options.sets;
  allocate.pSetLayouts = layouts.data();
  sets_.resize(options.sets);
  gpu::check(vkAllocateDescriptorSets(device_.handle(), &allocate, sets_.data()), "vkAllocateDescriptorSets");
}

void ToolKernel::record(VkCommandBuffer commands, uint32_t set, std::span<const ToolBinding> bindings,
                        std::span<const std::byte> push, uint32_t width, uint32_t height) const {
  if (bindings.size() != images_.size() || push.size() != pushBytes_ || set >= sets_.size())
    throw InputError(fmt::format("a kernel of {} bindings, {} bytes and {} sets got {}, {} and number {}",
                                 images_.size(), pushBytes_, sets_.size(), bindings.size(), push.size(), set));
  constexpr size_t kMost = 16;
  std::array<VkDescriptorBufferInfo, kMost> buffers{};
  std::array<VkDescriptorImageInfo, kMost> images{};
  std::array<VkWriteDescriptorSet, kMost> writes{};
  if (bindings.size() > kMost) throw InputError(fmt::format("a kernel has at most {} bindings", kMost));
  for (uint32_t b = 0; b < bindings.size(); ++b) {
    writes[b].sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
    writes[b].dstSet = sets_[set];
    writes[b].dstBinding = b;
    writes[b].descriptorCount = 1;
    if (images_[b]) {
      images[b] = {VK_NULL_HANDLE, bindings[b].image, VK_IMAGE_LAYOUT_GENERAL};
      writes[b].descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
      writes[b].pImageInfo = &images[b];
    } else {
      buffers[b] = {bindings[b].buffer, 0, VK_WHOLE_SIZE};
      writes[b].descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
      writes[b].pBufferInfo = &buffers[b];
    }
  }
  vkUpdateDescriptorSets(device_.handle(), static_cast<uint32_t>(bindings.size()), writes.data(), 0, nullptr);
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline_.handle());
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout_, 0, 1, &sets_[set], 0, nullptr);
  if (pushBytes_ > 0) vkCmdPushConstants(commands, layout_, VK_SHADER_STAGE_COMPUTE_BIT, 0, pushBytes_, push.data());
  pipeline_.launch(commands, width, height);
}

}  // namespace weir::execute
