// Buffers and images that free themselves.
#pragma once

#include <weir/gpu/device.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace weir::gpu {

enum class Residency : uint8_t {
  Device,    ///< GPU only
  Upload,    ///< host writes in order, GPU reads; persistently mapped
  Readback,  ///< GPU writes, host reads; persistently mapped, cached
};

/// What a buffer or an image asks of the memory it lies in; `kinds` is a mask of memory types. Rounded up so that
/// buffers and images may lie side by side.
struct MemoryNeeds {
  uint64_t bytes = 0, alignment = 1;
  uint32_t kinds = 0;
};

/// Device memory that several buffers and images lie in, also over each other.
class Memory {
 public:
  Memory() = default;
  Memory(const Device& device, const MemoryNeeds& needs, const std::string& name);
  ~Memory();
  Memory(Memory&& other) noexcept;
  Memory& operator=(Memory&& other) noexcept;
  VmaAllocation allocation() const { return allocation_; }

 private:
  const Device* device_ = nullptr;
  VmaAllocation allocation_ = nullptr;
};

class Buffer {
 public:
  Buffer() = default;
  /// In memory that is somebody else's; it must outlive the buffer.
  Buffer(const Device& device, uint64_t size, VkBufferUsageFlags usage, const Memory& memory, uint64_t offset,
         const std::string& name);
  /// Somebody else's buffer, never freed here.
  static Buffer borrowed(VkBuffer buffer, uint64_t size);
  /// `size` 0 makes a 16-byte buffer, so that there is always something to bind.
  Buffer(const Device& device, uint64_t size, VkBufferUsageFlags usage, Residency residency, const std::string& name,
         uint64_t alignment = 0);
  ~Buffer();
  Buffer(Buffer&& other) noexcept;
  Buffer& operator=(Buffer&& other) noexcept;

  VkBuffer handle() const { return buffer_; }
  uint64_t size() const { return size_; }
  VkDeviceAddress address() const { return address_; }  ///< 0 unless VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT
  std::byte* mapped() const { return mapped_; }         ///< nullptr when Device
  void flush() const;                                   ///< after host writes
  void invalidate() const;                              ///< before host reads
  explicit operator bool() const { return buffer_ != VK_NULL_HANDLE; }

 private:
  const Device* device_ = nullptr;
  VkBuffer buffer_ = VK_NULL_HANDLE;
  VmaAllocation allocation_ = nullptr;
  uint64_t size_ = 0;
  VkDeviceAddress address_ = 0;
  std::byte* mapped_ = nullptr;
};

struct ImageDesc {
  uint32_t width = 1, height = 1, depth = 1;
  uint32_t mipLevels = 1;
  VkFormat format = VK_FORMAT_R8G8B8A8_UNORM;
  VkImageUsageFlags usage = 0;
  VkImageType type = VK_IMAGE_TYPE_2D;
};

/// An image with one view of all of it. Starts in VK_IMAGE_LAYOUT_UNDEFINED.
class Image {
 public:
  Image() = default;
  Image(const Device& device, const ImageDesc& desc, const std::string& name);
  /// In memory that is somebody else's; it must outlive the image.
  Image(const Device& device, const ImageDesc& desc, const Memory& memory, uint64_t offset, const std::string& name);
  /// Somebody else's image with a view of it, never freed here.
  static Image borrowed(VkImage image, VkImageView view, const ImageDesc& desc);
  ~Image();
  Image(Image&& other) noexcept;
  Image& operator=(Image&& other) noexcept;

  VkImage handle() const { return image_; }
  VkImageView view() const { return view_; }
  const ImageDesc& desc() const { return desc_; }
  uint64_t bytes() const { return bytes_; }  ///< what the allocation takes
  VkImageAspectFlags aspect() const;
  explicit operator bool() const { return image_ != VK_NULL_HANDLE; }

 private:
  const Device* device_ = nullptr;
  VkImage image_ = VK_NULL_HANDLE;
  VkImageView view_ = VK_NULL_HANDLE;
  void makeView(const std::string& name);
  VmaAllocation allocation_ = nullptr;
  ImageDesc desc_;
  uint64_t bytes_ = 0;
};

MemoryNeeds bufferNeeds(const Device& device, uint64_t size, VkBufferUsageFlags usage);
MemoryNeeds imageNeeds(const Device& device, const ImageDesc& desc);

/// Device-local buffer filled with `bytes` through a staging copy; waits. `usage` gets TRANSFER_DST added.
Buffer uploadBuffer(const Device& device, std::span<const std::byte> bytes, VkBufferUsageFlags usage,
                    const std::string& name);
template <typename T>
Buffer uploadBuffer(const Device& device, const std::vector<T>& values, VkBufferUsageFlags usage,
                    const std::string& name) {
  return uploadBuffer(device, std::as_bytes(std::span(values)), usage, name);
}

/// Image filled with tightly packed texels (level 0) and left in SHADER_READ_ONLY_OPTIMAL; waits. Adds TRANSFER_DST and
/// SAMPLED.
Image uploadImage(const Device& device, ImageDesc desc, std::span<const std::byte> texels, const std::string& name);
/// The same with all of desc.mipLevels: `levels` has those from level 1 on, tightly packed one behind the other. Of an
/// uncompressed colour format.
Image uploadImage(const Device& device, ImageDesc desc, std::span<const std::byte> texels,
                  std::span<const std::byte> levels, const std::string& name);

/// Copies a buffer's bytes back (needs TRANSFER_SRC); waits.
std::vector<std::byte> readBuffer(const Device& device, const Buffer& buffer);

/// Bytes of the device's own memory that allocations may still take, of the heap that has the most: an estimate, which
/// knows nothing of other programs.
uint64_t freeDeviceBytes(const Device& device);

/// A memory barrier between everything before and everything after; for tests and loading.
void fullBarrier(VkCommandBuffer commands);

}  // namespace weir::gpu
