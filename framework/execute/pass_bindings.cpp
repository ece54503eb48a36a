// A pass's descriptors: set 1, one binding for each input, output, scratch resource, texture and buffer of the light
// tree, in that order.
#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/execute/pass_runtime.h>
#include <weir/scene/upload_light_tree.h>

#include <algorithm>

namespace weir::execute {
namespace {

VkDescriptorType descriptorType(const PortType& type) {
  return type.kind == PortKind::Buffer ? VK_DESCRIPTOR_TYPE_STORAGE_BUFFER : VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
}

}  // namespace

void PassRuntime::makeLayouts() {
  if (setLayout_ != VK_NULL_HANDLE) return;
  const PassDescription& d = *compiled().description;
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  uint32_t binding = 0;
  auto add = [&](VkDescriptorType type, bool used) {
    if (used) bindings.push_back({binding, type, 1, VK_SHADER_STAGE_ALL, nullptr});
    ++binding;
  };
  for (size_t i = 0; i < d.inputs.size(); ++i) {
    add(descriptorType(d.inputs[i].type), compiled().inputs[i].resource != graph::kNone);
  }
  for (const PortDescription& output : d.outputs) add(descriptorType(output.type), true);
  for (const Scratch& s : interface_.scratch) add(descriptorType(s.type), true);
  for (size_t i = 0; i < textures_.size(); ++i) add(VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, true);
  if (interface_.lightTree)
    for (uint32_t i = 0; i < scene::LightTreeGpu::kBuffers; ++i) add(VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, true);

  VkDescriptorSetLayoutCreateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  info.bindingCount = static_cast<uint32_t>(bindings.size());
  info.pBindings = bindings.data();
  gpu::check(vkCreateDescriptorSetLayout(device().handle(), &info, nullptr, &setLayout_),
             "vkCreateDescriptorSetLayout");
  const std::array sets = {shared_.frame->scene().layout(), setLayout_};
  const VkPushConstantRange range{VK_SHADER_STAGE_ALL, 0, static_cast<uint32_t>(push_.size() * 4)};
  VkPipelineLayoutCreateInfo layout{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  layout.setLayoutCount = static_cast<uint32_t>(sets.size());
  layout.pSetLayouts = sets.data();
  layout.pushConstantRangeCount = 1;
  layout.pPushConstantRanges = &range;
  gpu::check(vkCreatePipelineLayout(device().handle(), &layout, nullptr, &pipelineLayout_), "vkCreatePipelineLayout");
}

/// What a name means that kernels use: "in_color", "out_color", "scratch_half".
PassRuntime::Slot PassRuntime::slotNamed(const std::string& name) const {
  const graph::CompiledPass& pass = compiled();
  for (const graph::Binding& b : pass.inputs)
    if (name == "in_" + b.port && b.resource != graph::kNone) return {0, b.resource, b.previous};
  for (const graph::Binding& b : pass.outputs)
    if (name == "out_" + b.port) return {0, b.resource, false};
  for (size_t i = 0, image = 0; i < pass.scratch.size(); ++i) {
    if (shared_.graph->resources[pass.scratch[i]].depth) continue;
    if (name == "scratch_" + interface_.scratch[image++].name) return {0, pass.scratch[i], false};
  }
  throw InputError(fmt::format("{} ({}): nothing is named '{}' there", pass.name, pass.type, name));
}

std::vector<PassRuntime::Slot> PassRuntime::slotsFor(const KernelOptions& options) const {
  const graph::CompiledPass& pass = compiled();
  std::vector<Slot> slots;
  const auto add = [&](const std::string& name, uint32_t binding) {
    std::string wanted = name;
    for (const auto& [from, to] : options.bind)
      if (from == name) wanted = to;
    Slot slot = slotNamed(wanted);
    if (shared_.graph->resources[slot.resource].isImage() !=
        shared_.graph->resources[slotNamed(name).resource].isImage())
      throw InputError(fmt::format("{}: '{}' can't stand for '{}'", pass.name, wanted, name));
    slot.binding = binding;
    slots.push_back(slot);
  };
  uint32_t binding = 0;
  for (const graph::Binding& b : pass.inputs) {
    if (b.resource != graph::kNone) add("in_" + b.port, binding);
    ++binding;
  }
  for (const graph::Binding& b : pass.outputs) add("out_" + b.port, binding++);
  for (const Scratch& s : interface_.scratch) add("scratch_" + s.name, binding++);
  return slots;
}

void PassRuntime::makeSets(PreparedKernel& kernel, uint32_t count) {
  const auto slots = static_cast<uint32_t>(kernel.slots.size()), textures = static_cast<uint32_t>(textures_.size());
  const std::array<VkDescriptorPoolSize, 3> sizes = {
      {{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, count * (slots + scene::LightTreeGpu::kBuffers) + 1},
       {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, count * slots + 1},
       {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, count * textures + 1}}};
  VkDescriptorPoolCreateInfo poolInfo{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  poolInfo.maxSets = count;
  poolInfo.poolSizeCount = static_cast<uint32_t>(sizes.size());
  poolInfo.pPoolSizes = sizes.data();
  VkDescriptorPool pool = VK_NULL_HANDLE;
  gpu::check(vkCreateDescriptorPool(device().handle(), &poolInfo, nullptr, &pool), "vkCreateDescriptorPool");
  pools_.push_back(pool);
  const std::vector<VkDescriptorSetLayout> layouts(count, setLayout_);
  VkDescriptorSetAllocateInfo allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  allocate.descriptorPool = pool;
  allocate.descriptorSetCount = count;
  allocate.pSetLayouts = layouts.data();
  kernel.sets.resize(count);
  gpu::check(vkAllocateDescriptorSets(device().handle(), &allocate, kernel.sets.data()), "vkAllocateDescriptorSets");
}

void PassRuntime::writeSet(const PreparedKernel& kernel, VkDescriptorSet set, const Resources& resources, uint32_t slot,
                           uint32_t parity) const {
  std::vector<VkDescriptorBufferInfo> buffers(kernel.slots.size());
  std::vector<VkDescriptorImageInfo> images(kernel.slots.size() + textures_.size());
  std::vector<VkWriteDescriptorSet> writes;
  const auto add = [&](uint32_t binding, VkDescriptorType type) -> VkWriteDescriptorSet& {
    VkWriteDescriptorSet& w = writes.emplace_back(VkWriteDescriptorSet{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET});
    w.dstSet = set;
    w.dstBinding = binding;
    w.descriptorCount = 1;
    w.descriptorType = type;
    return w;
  };
  for (size_t i = 0; i < kernel.slots.size(); ++i) {
    const Slot& s = kernel.slots[i];
    const bool external = shared_.graph->resources[s.resource].external;
    const Storage& storage =
        external ? resources.external(s.resource, slot) : resources.at(s.resource, parity, s.previous);
    if (!storage) continue;  // the host has not brought it yet
    if (storage.buffer) {
      // A host's buffer may be larger than shaders may see.
      buffers[i] = {storage.buffer.handle(), 0, external ? shared_.graph->resources[s.resource].bytes : VK_WHOLE_SIZE};
      add(s.binding, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER).pBufferInfo = &buffers[i];
    } else {
      images[i] = {VK_NULL_HANDLE, storage.image.view(), VK_IMAGE_LAYOUT_GENERAL};
      add(s.binding, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE).pImageInfo = &images[i];
    }
  }
  const auto firstTexture =
      static_cast<uint32_t>(compiled().inputs.size() + compiled().outputs.size() + interface_.scratch.size());
  for (size_t i = 0; i < textures_.size(); ++i) {
    VkDescriptorImageInfo& image = images[kernel.slots.size() + i];
    image = {textures_[i].sampler, textures_[i].image.view(), VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    add(firstTexture + static_cast<uint32_t>(i), VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER).pImageInfo = &image;
  }
  std::array<VkDescriptorBufferInfo, scene::LightTreeGpu::kBuffers> tree{};
  if (interface_.lightTree) {
    const auto handles = shared_.frame->scene().lightTree().buffers();
    for (uint32_t i = 0; i < tree.size(); ++i) {
      tree[i] = {handles[i], 0, VK_WHOLE_SIZE};
      add(firstTexture + static_cast<uint32_t>(textures_.size()) + i, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER).pBufferInfo =
          &tree[i];
    }
  }
  vkUpdateDescriptorSets(device().handle(), static_cast<uint32_t>(writes.size()), writes.data(), 0, nullptr);
}

void PassRuntime::writeSets(const PreparedKernel& kernel, uint32_t laneOrSlot) const {
  const uint32_t lane = bySlot_ ? 0 : laneOrSlot, slot = bySlot_ ? laneOrSlot : 0;
  for (uint32_t parity = 0; parity < 2; ++parity)
    writeSet(kernel, kernel.sets[2 * laneOrSlot + parity], *lanes_[lane], slot, parity);
}

void PassRuntime::bind(std::span<const std::unique_ptr<Resources>> lanes, bool bySlot) {
  bySlot_ = bySlot;
  lanes_.clear();
  for (const auto& lane : lanes) lanes_.push_back(lane.get());
  const uint32_t count = bySlot ? SceneFrame::kSlots : static_cast<uint32_t>(lanes.size());
  for (PreparedKernel& kernel : kernels_) {
    makeSets(kernel, 2 * count);
    for (uint32_t i = 0; i < count; ++i) writeSets(kernel, i);
  }
}

void PassRuntime::rebind(uint32_t slot, uint32_t resource) {
  for (const PreparedKernel& kernel : kernels_)
    if (std::ranges::any_of(kernel.slots, [&](const Slot& s) { return s.resource == resource; }))
      writeSets(kernel, slot);
}

}  // namespace weir::execute
