// The compiled graph's buffers and images on the device. History has two copies, written in turn.
#pragma once

#include <weir/gpu/memory.h>
#include <weir/graph/compile.h>

#include <array>
#include <vector>

namespace weir::execute {

/// A buffer or an image, with what descriptors need.
struct Storage {
  gpu::Buffer buffer;
  gpu::Image image;  ///< always in VK_IMAGE_LAYOUT_GENERAL
  uint64_t bytes = 0;
  explicit operator bool() const { return static_cast<bool>(buffer) || static_cast<bool>(image); }
};

VkFormat vulkanFormat(Format format);

/// A storage for one copy of a resource of this type. Images are moved to GENERAL by `toGeneral`.
Storage makeStorage(const gpu::Device& device, const PortType& type, uint32_t width, uint32_t height, uint64_t elements,
                    bool attachment, const std::string& name);
void toGeneral(VkCommandBuffer commands, const gpu::Image& image);
/// Fills with the layout's empty word, images with zero. The caller provides the barriers.
void clear(VkCommandBuffer commands, const Storage& storage, const PortType& type);

class Resources {
 public:
  Resources(const gpu::Device& device, const graph::CompiledGraph& graph);

  /// The copy that the frame with this parity writes, or the one that the frame before it wrote.
  const Storage& at(uint32_t resource, uint32_t parity, bool previous) const;
  /// Clears both copies of every history resource to its empty value.
  void clearHistory(VkCommandBuffer commands) const;

  uint64_t transientBytes() const { return transientBytes_; }
  uint64_t historyBytes() const { return historyBytes_; }

 private:
  const graph::CompiledGraph* graph_;
  std::vector<std::array<Storage, 2>> copies_;  ///< the second one is empty without history
  uint64_t transientBytes_ = 0, historyBytes_ = 0;
};

}  // namespace weir::execute
