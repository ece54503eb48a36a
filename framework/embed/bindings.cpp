// The host's images and buffers in a graph's places, and the barriers that take them over and hand them back.
#include <weir/core/text.h>
#include <weir/embed/call.h>

#include <algorithm>

using namespace weir;
using namespace weir::embed;

namespace {

std::string vulkanName(VkFormat format) {
  for (Format f : {Format::R32F, Format::RG32F, Format::RGBA32F, Format::RGBA16F, Format::RGBA8, Format::R32U})
    if (execute::vulkanFormat(f) == format) return fmt::format("{} (VkFormat {})", formatName(f), int(format));
  return fmt::format("VkFormat {}", int(format));
}

bool isWritten(const graph::Resource& r) {
  return r.producer != graph::kNone;
}

void checkSlot(const std::string& name, uint32_t slot) {
  if (slot >= WEIR_SLOTS) throw InputError(fmt::format("'{}': slot {}; expected 0 to {}", name, slot, WEIR_SLOTS - 1));
}

void checkLayouts(const std::string& name, const WeirAccess& before, const WeirAccess& after, bool written) {
  if (before.layout == VK_IMAGE_LAYOUT_UNDEFINED && !written)
    throw InputError(
        fmt::format("'{}' is read by the graph, and before.layout UNDEFINED would throw its content away", name));
  if (after.layout == VK_IMAGE_LAYOUT_UNDEFINED || after.layout == VK_IMAGE_LAYOUT_PREINITIALIZED)
    throw InputError(fmt::format("'{}': after.layout must be one that an image can be put into", name));
}

void checkImage(const graph::Resource& port, const WeirImage& image) {
  const std::string& name = port.name;
  if (!port.isImage())
    throw InputError(fmt::format("'{}' is {}, not an image: bind it with weirBindBuffer", name, describe(port.type)));
  if (image.image == VK_NULL_HANDLE || image.view == VK_NULL_HANDLE)
    throw InputError(fmt::format("'{}': image and view must both be given", name));
  const VkFormat expected = execute::vulkanFormat(port.type.format);
  if (image.format != expected)
    throw InputError(fmt::format("'{}': the image's format is {}; expected {}", name, vulkanName(image.format),
                                 vulkanName(expected)));
  if (image.width != port.width || image.height != port.height)
    throw InputError(fmt::format("'{}': the image is {}x{}; expected {}x{}", name, image.width, image.height,
                                 port.width, port.height));
  if ((image.usage & VK_IMAGE_USAGE_STORAGE_BIT) == 0)
    throw InputError(fmt::format("'{}': the image was made without VK_IMAGE_USAGE_STORAGE_BIT", name));
  checkLayouts(name, image.before, image.after, isWritten(port));
}

void checkBuffer(const graph::Resource& port, const WeirBuffer& buffer) {
  const std::string& name = port.name;
  if (port.isImage())
    throw InputError(fmt::format("'{}' is an {}, not a buffer: bind it with weirBindImage", name, describe(port.type)));
  if (buffer.buffer == VK_NULL_HANDLE) throw InputError(fmt::format("'{}': the buffer must be given", name));
  if (buffer.bytes < port.bytes)
    throw InputError(fmt::format("'{}': the buffer has {} bytes; expected at least {} ({} elements of {})", name,
                                 buffer.bytes, port.bytes, port.elements, describe(port.type)));
  if ((buffer.usage & VK_BUFFER_USAGE_STORAGE_BUFFER_BIT) == 0)
    throw InputError(fmt::format("'{}': the buffer was made without VK_BUFFER_USAGE_STORAGE_BUFFER_BIT", name));
}

/// Either side of a barrier: the host's use and the graph's.
template <typename Barrier>
void fill(Barrier& b, const WeirAccess& host, const WeirAccess& own, bool before) {
  const WeirAccess &from = before ? host : own, &to = before ? own : host;
  b.srcStageMask = from.stages;
  b.srcAccessMask = from.access;
  b.dstStageMask = to.stages;
  b.dstAccessMask = to.access;
  b.srcQueueFamilyIndex = b.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
}

}  // namespace

const graph::Resource& WeirGraph::port(const std::string& name) const {
  std::vector<std::string> names;
  for (const graph::Resource& r : runtime->graph().resources) {
    if (!r.external) continue;
    if (r.name == name) return r;
    names.push_back(r.name);
  }
  const std::string nearest = nearestName(name, names);
  throw InputError(fmt::format("graph '{}' has no place of the host's called '{}'{}", runtime->graph().name, name,
                               nearest.empty() ? "; name it under provided or external when the graph is made"
                                               : fmt::format(" (nearest: '{}')", nearest)));
}

void WeirGraph::bind(Bound b) {
  const graph::Resource& r = port(b.name);
  checkSlot(b.name, b.slot);
  if (b.isImage)
    checkImage(r, b.image);
  else
    checkBuffer(r, b.buffer);
  b.written = isWritten(r);
  b.image.name = b.buffer.name = nullptr;  // the caller's text, which need not stay
  put(b);
  for (const Bound& other : bound) {
    if (!b.isImage || !other.isImage || other.slot != b.slot || other.name == b.name ||
        other.image.image != b.image.image)
      continue;
    const auto same = [](const WeirAccess& x, const WeirAccess& y) {
      return x.stages == y.stages && x.access == y.access && x.layout == y.layout;
    };
    if (b.written || other.written || !same(b.image.before, other.image.before) ||
        !same(b.image.after, other.image.after))
      throw InputError(
          fmt::format("'{}' and '{}' are the same image; expected that of two that are only read, handed "
                      "over in the same way",
                      b.name, other.name));
  }
  std::erase_if(bound, [&](const Bound& other) { return other.name == b.name && other.slot == b.slot; });
  bound.push_back(std::move(b));
}

void WeirGraph::put(const Bound& b) {
  execute::Storage storage;
  if (b.isImage) {
    gpu::ImageDesc desc;
    desc.width = b.image.width;
    desc.height = b.image.height;
    desc.format = b.image.format;
    desc.usage = b.image.usage;
    storage.image = gpu::Image::borrowed(b.image.image, b.image.view, desc);
  } else {
    storage.buffer = gpu::Buffer::borrowed(b.buffer.buffer, b.buffer.bytes);
  }
  runtime->setExternal(b.name, b.slot, std::move(storage));
}

void WeirGraph::hostBarrier(VkCommandBuffer commands, uint32_t slot, bool before) const {
  // A graph in which nothing runs still takes images from one layout to another.
  const bool idle = runtime->stages() == 0;
  const VkPipelineStageFlags2 stages = idle ? VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT : runtime->stages();
  std::vector<VkImageMemoryBarrier2> images;
  std::vector<VkBufferMemoryBarrier2> buffers;
  for (const Bound& b : bound) {
    if (b.slot != slot) continue;
    WeirAccess own{stages, VK_ACCESS_2_SHADER_STORAGE_READ_BIT, VK_IMAGE_LAYOUT_GENERAL};
    if (b.written) own.access |= VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
    if (idle) own.access = 0;
    if (!b.isImage) {
      VkBufferMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_BUFFER_MEMORY_BARRIER_2};
      fill(barrier, before ? b.buffer.before : b.buffer.after, own, before);
      barrier.buffer = b.buffer.buffer;
      barrier.size = VK_WHOLE_SIZE;
      buffers.push_back(barrier);
      continue;
    }
    // One image that is read in two places is one image.
    if (std::ranges::any_of(images, [&](const VkImageMemoryBarrier2& i) { return i.image == b.image.image; })) continue;
    VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
    fill(barrier, before ? b.image.before : b.image.after, own, before);
    barrier.oldLayout = before ? b.image.before.layout : own.layout;
    barrier.newLayout = before ? own.layout : b.image.after.layout;
    barrier.image = b.image.image;
    barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    images.push_back(barrier);
  }
  if (images.empty() && buffers.empty()) return;
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.bufferMemoryBarrierCount = static_cast<uint32_t>(buffers.size());
  info.pBufferMemoryBarriers = buffers.data();
  info.imageMemoryBarrierCount = static_cast<uint32_t>(images.size());
  info.pImageMemoryBarriers = images.data();
  vkCmdPipelineBarrier2(commands, &info);
}

void WeirGraph::record(VkCommandBuffer commands, const execute::FrameInput& input, uint32_t slot,
                       const execute::Stamps& stamps) {
  checkSlot("frame", slot);
  // The host says by recording for a slot that its last frame is done.
  for (Retired& r : retired) r.slots &= ~(1u << slot);
  std::erase_if(retired, [](const Retired& r) { return r.slots == 0; });
  runtime->checkExternals(slot);
  // Frames of the runtime before used other stages than those that this one's barriers know.
  if (replaced) gpu::fullBarrier(commands);
  hostBarrier(commands, slot, true);
  recorded |= 1u << slot;
  try {
    runtime->record(commands, input, slot, stamps);
  } catch (const std::exception& error) {
    frame.forget();  // the host throws these commands away, and what they would have kept
    throw RuntimeError(error.what());
  }
  hostBarrier(commands, slot, false);
  replaced = false;
}

WeirStatus weirDescribePort(WeirGraph* graph, const char* name, WeirPort* port) {
  Weir* weir = weirOf(graph);
  return call(weir, [&] {
    (void)given(name, "name");
    (void)sized(port, "WeirPort");
    const graph::Resource& r = graph->port(name);
    for (const graph::Resource& each : graph->runtime->graph().resources)
      if (each.external) weir->lines.push_back(each.name);
    port->format = r.isImage() ? execute::vulkanFormat(r.type.format) : VK_FORMAT_UNDEFINED;
    port->width = r.width;
    port->height = r.height;
    port->bytes = r.isImage() ? 0 : r.bytes;
    port->written = isWritten(r) ? 1 : 0;
  });
}

WeirStatus weirBindImage(WeirGraph* graph, const WeirImage* image) {
  return call(weirOf(graph), [&] {
    Bound b;
    b.isImage = true;
    b.image = sized(image, "WeirImage");
    b.name = text(&given(image->name, "WeirImage.name"));
    b.slot = image->slot;
    graph->bind(std::move(b));
  });
}

WeirStatus weirBindBuffer(WeirGraph* graph, const WeirBuffer* buffer) {
  return call(weirOf(graph), [&] {
    Bound b;
    b.buffer = sized(buffer, "WeirBuffer");
    b.name = text(&given(buffer->name, "WeirBuffer.name"));
    b.slot = buffer->slot;
    graph->bind(std::move(b));
  });
}
