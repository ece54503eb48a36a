#include "view/picture/probe.h"

#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/gpu/barrier.h>

#include <algorithm>
#include <cstring>

namespace weir::view {
namespace {

/// Whether words are the same for both: then no texts are copied.
bool sameKind(const graph::Resource& a, const graph::Resource& b) {
  return a.name == b.name && compatible(a.type, b.type) && a.type.fixedCount == b.type.fixedCount &&
         a.width == b.width && a.height == b.height && a.perPixel == b.perPixel && a.elements == b.elements;
}

/// Where a pixel's elements lie in a buffer, clipped to what there is.
VkBufferCopy elementsOf(const Port& port, const Extent& extent, PixelPlace pixel) {
  const graph::Resource& r = port.resource;
  const uint64_t stride = r.type.layout.stride, each = stride * (r.type.fixedCount == 0 ? std::max(r.perPixel, 1u) : 1);
  const uint64_t offset = (uint64_t{pixel.y} * extent.width + pixel.x) * each;
  const uint64_t whole = std::min(r.elements * stride, port.storage.buffer.size());
  return {offset, 0, offset < whole ? std::min({each, whole - offset, uint64_t{Probe::kBytes}}) : 0};
}

}  // namespace

Probe::Probe(const gpu::Device& device, uint32_t slots) {
  for (uint32_t i = 0; i < slots; ++i) {
    Slot& slot = slots_.emplace_back();
    slot.buffer = gpu::Buffer(device, kBytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Residency::Readback, "probe");
    slot.probed.bytes.reserve(kBytes);
  }
}

bool Probe::record(VkCommandBuffer commands, uint32_t slotIndex, const Port& port, PixelPlace pixel) {
  if (slotIndex >= slots_.size()) throw InputError(fmt::format("slot {}: there are {}", slotIndex, slots_.size()));
  const graph::Resource& r = port.resource;
  if (!(r.isImage() ? static_cast<bool>(port.storage.image) : static_cast<bool>(port.storage.buffer)) || r.depth)
    throw InputError(fmt::format("'{}' can't be looked at: it has no memory that is read", r.name));
  Slot& slot = slots_[slotIndex];
  slot.pending = false;
  const Extent extent = extentOf(r);
  if (pixel.x >= extent.width || pixel.y >= extent.height) return false;
  const VkBufferCopy part =
      r.isImage() ? VkBufferCopy{0, 0, formatBytes(r.type.format)} : elementsOf(port, extent, pixel);
  if (part.size == 0) return false;

  constexpr VkPipelineStageFlags2 kAll = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, kCopy = VK_PIPELINE_STAGE_2_COPY_BIT;
  gpu::memoryBarrier(commands, kAll, VK_ACCESS_2_MEMORY_WRITE_BIT, kCopy,
                     VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT);
  if (r.isImage()) {
    VkBufferImageCopy copy{};
    copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    copy.imageOffset = {static_cast<int32_t>(pixel.x), static_cast<int32_t>(pixel.y), 0};
    copy.imageExtent = {1, 1, 1};
    vkCmdCopyImageToBuffer(commands, port.storage.image.handle(), VK_IMAGE_LAYOUT_GENERAL, slot.buffer.handle(), 1,
                           &copy);
  } else {
    vkCmdCopyBuffer(commands, port.storage.buffer.handle(), slot.buffer.handle(), 1, &part);
  }
  // The host reads the copy; the next frame overwrites the port.
  gpu::memoryBarrier(commands, kCopy, VK_ACCESS_2_TRANSFER_WRITE_BIT, kAll | VK_PIPELINE_STAGE_2_HOST_BIT,
                     VK_ACCESS_2_HOST_READ_BIT | VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT);
  if (!sameKind(slot.probed.resource, r)) slot.probed.resource = r;
  slot.probed.pixel = pixel;
  slot.probed.camera = port.camera;
  slot.probed.f90 = port.f90;
  slot.probed.bytes.resize(part.size);
  slot.pending = true;
  return true;
}

const Probed* Probe::collect(uint32_t slotIndex) {
  if (slotIndex >= slots_.size()) throw InputError(fmt::format("slot {}: there are {}", slotIndex, slots_.size()));
  Slot& slot = slots_[slotIndex];
  if (!slot.pending) return nullptr;
  slot.pending = false;
  slot.buffer.invalidate();
  std::memcpy(slot.probed.bytes.data(), slot.buffer.mapped(), slot.probed.bytes.size());
  return &slot.probed;
}

}  // namespace weir::view
