#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/execute/resources.h>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

namespace weir::execute {
namespace {

constexpr VkBufferUsageFlags kBufferUsage =
    VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;

bool sameType(const PortType& a, const PortType& b) {
  return compatible(a, b) && a.layout.emptyWord == b.layout.emptyWord;
}

/// Whether all who read a resource as previous, and did so in the graph before, read the same one there. One that read
/// another has another producer from now on, and starts without a past.
bool sameReaders(const graph::CompiledGraph& before, const graph::CompiledGraph& now, uint32_t resource) {
  for (const graph::CompiledPass& pass : now.passes)
    for (const graph::Binding& b : pass.inputs) {
      if (!b.previous || b.resource != resource) continue;
      for (const graph::CompiledPass& old : before.passes)
        for (const graph::Binding& o : old.inputs)
          if (old.name == pass.name && o.port == b.port && o.previous &&
              before.resources[o.resource].name != now.resources[resource].name)
            return false;
    }
  return true;
}

/// Whether history may go on as if nothing had happened: the same values, made by the same pass.
bool sameHistory(const graph::CompiledGraph& ga, const graph::Resource& a, const graph::CompiledGraph& gb,
                 const graph::Resource& b) {
  return a.history && b.history && a.name == b.name && sameType(a.type, b.type) && a.width == b.width &&
         a.height == b.height && a.elements == b.elements && a.bytes == b.bytes && ga.width == gb.width &&
         ga.height == gb.height && ga.passes[a.producer].type == gb.passes[b.producer].type;
}

}  // namespace

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

gpu::ImageDesc imageDesc(const gpu::Device& device, const graph::Resource& resource) {
  gpu::ImageDesc desc;
  desc.width = resource.width;
  desc.height = resource.height;
  desc.format = resource.depth ? VK_FORMAT_D32_SFLOAT : vulkanFormat(resource.type.format);
  if (resource.depth) {
    desc.usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    return desc;
  }
  desc.usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  // What a raster kernel may draw into.
  if (resource.scratch && resource.type.format == Format::R32U && device.capabilities().graphics)
    desc.usage |= VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
  return desc;
}

std::vector<graph::MemoryNeed> deviceNeeds(const gpu::Device& device, const graph::CompiledGraph& graph) {
  std::vector<graph::MemoryNeed> needs;
  for (const graph::Resource& r : graph.resources) {
    const gpu::MemoryNeeds n =
        r.isImage() ? imageNeeds(device, imageDesc(device, r)) : bufferNeeds(device, r.bytes, kBufferUsage);
    needs.push_back({n.bytes, n.alignment, n.kinds});
  }
  return needs;
}

void checkLimits(const gpu::Device& device, const graph::CompiledGraph& graph) {
  VkPhysicalDeviceProperties properties;
  vkGetPhysicalDeviceProperties(device.physical(), &properties);
  const uint32_t side = properties.limits.maxImageDimension2D;
  const uint64_t range = device.capabilities().maxStorageBufferRange;
  for (const graph::Resource& r : graph.resources) {
    if (r.isImage() && (r.width > side || r.height > side))
      throw InputError(fmt::format("'{}' is {}x{}, and images of {} have at most {} pixels each way", r.name, r.width,
                                   r.height, device.info().name, side));
    if (!r.isImage() && r.bytes > range)
      throw InputError(fmt::format("'{}' takes {} bytes, and shaders of {} see at most {} of a buffer", r.name, r.bytes,
                                   device.info().name, range));
  }
}

VkImageMemoryBarrier2 toGeneral(const gpu::Image& image) {
  VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
  barrier.srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
  barrier.oldLayout = VK_IMAGE_LAYOUT_UNDEFINED;
  barrier.newLayout = VK_IMAGE_LAYOUT_GENERAL;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image.handle();
  barrier.subresourceRange = {image.aspect(), 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS};
  return barrier;
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

void poison(VkCommandBuffer commands, const Storage& storage, const graph::Resource& resource) {
  constexpr uint32_t kPoison = 0xcdcdcdcdu;
  if (storage.buffer) {
    vkCmdFillBuffer(commands, storage.buffer.handle(), 0, VK_WHOLE_SIZE, kPoison);
    return;
  }
  const VkImageSubresourceRange range{storage.image.aspect(), 0, 1, 0, 1};
  if (resource.depth) {
    const VkClearDepthStencilValue value{0.25f, 0};
    vkCmdClearDepthStencilImage(commands, storage.image.handle(), VK_IMAGE_LAYOUT_GENERAL, &value, 1, &range);
    return;
  }
  VkClearColorValue value{};
  for (int c = 0; c < 4; ++c) {
    if (resource.type.format == Format::R32U)
      value.uint32[c] = kPoison;
    else
      value.float32[c] = std::numeric_limits<float>::quiet_NaN();
  }
  vkCmdClearColorImage(commands, storage.image.handle(), VK_IMAGE_LAYOUT_GENERAL, &value, 1, &range);
}

Resources::Resources(const gpu::Device& device, const graph::CompiledGraph& graph, const Resources* before)
    : graph_(&graph) {
  for (size_t b = 0; b < graph.blocks.size(); ++b) {
    const graph::MemoryBlock& block = graph.blocks[b];
    blocks_.emplace_back(device, gpu::MemoryNeeds{block.bytes, block.alignment, block.kinds},
                         graph.name + " shared block " + std::to_string(b + 1));
  }
  for (std::vector<Storage>& slot : external_) slot.resize(graph.resources.size());
  const auto make = [&](const graph::Resource& r, const std::string& name) {
    Storage s;
    const gpu::Memory* block = r.block == graph::kNone ? nullptr : &blocks_[r.block];
    if (r.isImage()) {
      const gpu::ImageDesc desc = imageDesc(device, r);
      s.image = block ? gpu::Image(device, desc, *block, r.offset, name) : gpu::Image(device, desc, name);
    } else {
      s.buffer = block ? gpu::Buffer(device, r.bytes, kBufferUsage, *block, r.offset, name)
                       : gpu::Buffer(device, r.bytes, kBufferUsage, gpu::Residency::Device, name);
    }
    return s;
  };
  std::vector<VkImageMemoryBarrier2> transitions;
  for (uint32_t i = 0; i < graph.resources.size(); ++i) {
    const graph::Resource& r = graph.resources[i];
    std::shared_ptr<Copies>& copies = copies_.emplace_back();
    if (r.external) continue;
    if (r.history && before != nullptr && adopt(*before, i)) continue;
    copies = std::make_shared<Copies>();
    (*copies)[0] = make(r, r.history ? r.name + " (even)" : r.name);
    if (r.history) {
      (*copies)[1] = make(r, r.name + " (odd)");
      fresh_.push_back(i);
    }
    if (r.shares) continue;  // put into the layout anew in every frame
    for (const Storage& s : *copies)
      if (s.image) transitions.push_back(toGeneral(s.image));
  }
  if (transitions.empty()) return;
  device.submitAndWait([&](VkCommandBuffer commands) {
    VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    info.imageMemoryBarrierCount = static_cast<uint32_t>(transitions.size());
    info.pImageMemoryBarriers = transitions.data();
    vkCmdPipelineBarrier2(commands, &info);
  });
}

/// Goes on with history that is the same in the graph before; false when there is none such.
bool Resources::adopt(const Resources& before, uint32_t resource) {
  const graph::Resource& r = graph_->resources[resource];
  for (uint32_t k = 0; k < before.copies_.size(); ++k) {
    if (!sameHistory(*graph_, r, *before.graph_, before.graph_->resources[k])) continue;
    if (!sameReaders(*before.graph_, *graph_, resource)) continue;
    copies_[resource] = before.copies_[k];
    if (std::count(before.fresh_.begin(), before.fresh_.end(), k) > 0) fresh_.push_back(resource);
    return true;
  }
  return false;
}

const Storage& Resources::at(uint32_t resource, uint32_t parity, bool previous) const {
  const bool second = graph_->resources[resource].history && ((parity & 1u) != (previous ? 1u : 0u));
  return (*copies_[resource])[second ? 1 : 0];
}

void Resources::setExternal(uint32_t resource, uint32_t slot, Storage storage) {
  external_[slot][resource] = std::move(storage);
}

void Resources::clearHistory(VkCommandBuffer commands, bool all) const {
  for (uint32_t r = 0; r < copies_.size(); ++r) {
    if (!graph_->resources[r].history) continue;
    if (!all && std::count(fresh_.begin(), fresh_.end(), r) == 0) continue;
    for (const Storage& s : *copies_[r]) clear(commands, s, graph_->resources[r].type);
  }
}

}  // namespace weir::execute
