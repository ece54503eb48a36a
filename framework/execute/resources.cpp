#include <weir/execute/resources.h>

namespace weir::execute {

VkFormat vulkanFormat(Format format) {
  switch (format) {
    case Format::R32F:
      return VK_FORMAT_R32_SFLOAT;
    case Format::RG32F:
      return VK_FORMAT_R32G32_SFLOAT;
    case Format::RGBA32F:
      return VK_FORMAT_R32G32B32A32_SFLOAT;
    case Format::RGBA16F:
      return VK_FORMAT_R16G16B16A16_SFLOAT;
    case Format::RGBA8:
      return VK_FORMAT_R8G8B8A8_UNORM;
    case Format::R32U:
      return VK_FORMAT_R32_UINT;
  }
  return VK_FORMAT_UNDEFINED;
}

Storage makeStorage(const gpu::Device& device, const PortType& type, uint32_t width, uint32_t height, uint64_t elements,
                    bool attachment, const std::string& name) {
  constexpr uint32_t kTransferBoth = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  Storage s;
  if (type.kind == PortKind::Buffer) {
    s.buffer = gpu::Buffer(device, elements * type.layout.stride, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | kTransferBoth,
                           gpu::Residency::Device, name);
    s.bytes = s.buffer.size();
  } else {
    gpu::ImageDesc desc;
    desc.width = width;
    desc.height = height;
    desc.format = vulkanFormat(type.format);
    desc.usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    if (attachment) desc.usage |= VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    s.image = gpu::Image(device, desc, name);
    s.bytes = s.image.bytes();
  }
  return s;
}

void toGeneral(VkCommandBuffer commands, const gpu::Image& image) {
  VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
  barrier.srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
  barrier.oldLayout = VK_IMAGE_LAYOUT_UNDEFINED;
  barrier.newLayout = VK_IMAGE_LAYOUT_GENERAL;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image.handle();
  barrier.subresourceRange = {image.aspect(), 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS};
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.imageMemoryBarrierCount = 1;
  info.pImageMemoryBarriers = &barrier;
  vkCmdPipelineBarrier2(commands, &info);
}

void clear(VkCommandBuffer commands, const Storage& storage, const PortType& type) {
  if (storage.buffer) {
    vkCmdFillBuffer(commands, storage.buffer.handle(), 0, VK_WHOLE_SIZE, type.layout.emptyWord);
    return;
  }
  const VkClearColorValue zero{};
  const VkImageSubresourceRange range{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  vkCmdClearColorImage(commands, storage.image.handle(), VK_IMAGE_LAYOUT_GENERAL, &zero, 1, &range);
}

Resources::Resources(const gpu::Device& device, const graph::CompiledGraph& graph) : graph_(&graph) {
  for (const graph::Resource& r : graph.resources) {
    std::array<Storage, 2>& copies = copies_.emplace_back();
    for (int copy = 0; copy < (r.history ? 2 : 1); ++copy) {
      const std::string name = r.history ? r.name + (copy == 0 ? " (even)" : " (odd)") : r.name;
      copies[copy] = makeStorage(device, r.type, r.width, r.height, r.elements, false, name);
      (r.history ? historyBytes_ : transientBytes_) += copies[copy].bytes;
    }
  }
  device.submitAndWait([&](VkCommandBuffer commands) {
    for (const auto& copies : copies_) {
      for (const Storage& s : copies) {
        if (s.image) toGeneral(commands, s.image);
      }
    }
  });
}

const Storage& Resources::at(uint32_t resource, uint32_t parity, bool previous) const {
  const bool second = graph_->resources[resource].history && ((parity & 1u) != (previous ? 1u : 0u));
  return copies_[resource][second ? 1 : 0];
}

void Resources::clearHistory(VkCommandBuffer commands) const {
  for (size_t r = 0; r < copies_.size(); ++r) {
    if (!graph_->resources[r].history) continue;
    for (const Storage& s : copies_[r]) clear(commands, s, graph_->resources[r].type);
  }
}

}  // namespace weir::execute
