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

class Buffer {
 public:
  Buffer() = default;
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
  VmaAllocation allocation_ = nullptr;
  ImageDesc desc_;
  uint64_t bytes_ = 0;
};

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

/// A memory barrier between everything before and everything after; for tests and loading.
void fullBarrier(VkCommandBuffer commands);

}  // namespace weir::gpu
