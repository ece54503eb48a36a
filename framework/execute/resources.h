// The compiled graph's buffers and images on the device. Transient ones lie in blocks that the plan shares out among
// them; history has two copies of its own, written in turn.
#pragma once

#include <weir/gpu/memory.h>
#include <weir/graph/compile.h>

#include <array>
#include <memory>
#include <vector>

namespace weir::execute {

/// A buffer or an image, with what descriptors need.
struct Storage {
  gpu::Buffer buffer;
  gpu::Image image;  ///< in VK_IMAGE_LAYOUT_GENERAL whenever a pass uses it
  explicit operator bool() const { return static_cast<bool>(buffer) || static_cast<bool>(image); }
};

VkFormat vulkanFormat(Format format);
/// The image that a resource is on the device.
gpu::ImageDesc imageDesc(const gpu::Device& device, const graph::Resource& resource);

/// Asks the device what each resource needs of its memory.
std::vector<graph::MemoryNeed> deviceNeeds(const gpu::Device& device, const graph::CompiledGraph& graph);

/// InputError when a buffer is larger than shaders of this device can see, or an image than it can make.
void checkLimits(const gpu::Device& device, const graph::CompiledGraph& graph);

/// A barrier that puts an image into the layout GENERAL; its content becomes undefined.
VkImageMemoryBarrier2 toGeneral(const gpu::Image& image);
/// Fills with the layout's empty word, images with zero. The caller provides the barriers.
void clear(VkCommandBuffer commands, const Storage& storage, const PortType& type);
/// Fills with what nobody can take for a value: 0xcd bytes, NaN in float images. The caller provides the barriers.
void poison(VkCommandBuffer commands, const Storage& storage, const graph::Resource& resource);

class Resources {
 public:
  /// `graph` has its memory planned for this device. History is taken over from `before` where it is the same there.
  Resources(const gpu::Device& device, const graph::CompiledGraph& graph, const Resources* before);

  /// The copy that the frame with this parity writes, or the one that the frame before it wrote.
  const Storage& at(uint32_t resource, uint32_t parity, bool previous) const;
  /// Puts the host's own buffer or image in the place of an external resource, for frames of one slot.
  void setExternal(uint32_t resource, uint32_t slot, Storage storage);
  /// Of an external resource; not set yet: empty.
  const Storage& external(uint32_t resource, uint32_t slot) const { return external_[slot][resource]; }

  /// Whether there is history without content, to be cleared before the next frame.
  bool hasFresh() const { return !fresh_.empty(); }
  /// Clears both copies of history to its empty value: all of it, or what is fresh.
  void clearHistory(VkCommandBuffer commands, bool all) const;
  /// The frame that clears it is recorded: it is fresh no more.
  void setCleared() { fresh_.clear(); }

 private:
  using Copies = std::array<Storage, 2>;  ///< the second one is empty without history
  bool adopt(const Resources& before, uint32_t resource);
  const graph::CompiledGraph* graph_;
  std::vector<gpu::Memory> blocks_;
  std::vector<std::shared_ptr<Copies>> copies_;   ///< shared while one graph follows another
  std::array<std::vector<Storage>, 2> external_;  ///< by slot
  std::vector<uint32_t> fresh_;
};

}  // namespace weir::execute
