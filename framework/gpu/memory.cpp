#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/gpu/memory.h>
#include <weir/gpu/vma.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

namespace weir::gpu {
namespace {

VmaAllocationCreateInfo allocationFor(Residency residency) {
  switch (residency) {
    case Residency::Upload:
      return {.flags = VMA_ALLOCATION_CREATE_HOST_ACCESS_SEQUENTIAL_WRITE_BIT | VMA_ALLOCATION_CREATE_MAPPED_BIT,
              .usage = VMA_MEMORY_USAGE_AUTO};
    case Residency::Readback:
      // Uncached memory would make every host read a trip over the bus; VMA picks host-cached memory for random access.
      return {.flags = VMA_ALLOCATION_CREATE_HOST_ACCESS_RANDOM_BIT | VMA_ALLOCATION_CREATE_MAPPED_BIT,
              .usage = VMA_MEMORY_USAGE_AUTO_PREFER_HOST};
    case Residency::Device:
      break;
  }
  return {.usage = VMA_MEMORY_USAGE_AUTO_PREFER_DEVICE};
}

/// "Device memory" in the message, because the name of the call alone doesn't say what was too large.
void checkAllocation(VkResult result, const char* call, const std::string& name, uint64_t bytes) {
  if (result == VK_SUCCESS) return;
  throw RuntimeError(fmt::format("No memory for \"{}\" ({:.1f} MiB): {} gave {}.", name,
                                 static_cast<double>(bytes) / (1 << 20), call, resultName(result)));
}

void transition(VkCommandBuffer commands, const Image& image, VkImageLayout from, VkImageLayout to) {
  const VkImageMemoryBarrier2 barrier{
      .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
      .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
      .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
      .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
      .dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT,
      .oldLayout = from,
      .newLayout = to,
      .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
      .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
      .image = image.handle(),
      .subresourceRange = {image.aspect(), 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS}};
  const VkDependencyInfo dependency{
      .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .imageMemoryBarrierCount = 1, .pImageMemoryBarriers = &barrier};
  vkCmdPipelineBarrier2(commands, &dependency);
}

}  // namespace

Buffer::Buffer(const Device& device, uint64_t size, VkBufferUsageFlags usage, Residency residency,
               const std::string& name, uint64_t alignment)
    : device_(&device), size_(size == 0 ? 16 : size) {
  const VkBufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = size_, .usage = usage};
  const VmaAllocationCreateInfo allocate = allocationFor(residency);
  VmaAllocationInfo allocated;
  // Memory aligned to 1 is what the plain call asks for beyond the buffer's own needs.
  checkAllocation(vmaCreateBufferWithAlignment(device.allocator(), &info, &allocate, alignment == 0 ? 1 : alignment,
                                               &buffer_, &allocation_, &allocated),
                  "vmaCreateBuffer", name, size_);
  mapped_ = residency == Residency::Device ? nullptr : static_cast<std::byte*>(allocated.pMappedData);
  if (usage & VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT) {
    const VkBufferDeviceAddressInfo address{.sType = VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO, .buffer = buffer_};
    address_ = vkGetBufferDeviceAddress(device.handle(), &address);
  }
  vmaSetAllocationName(device.allocator(), allocation_, name.c_str());
  device.name(VK_OBJECT_TYPE_BUFFER, reinterpret_cast<uint64_t>(buffer_), name);
}

Buffer::Buffer(const Device& device, uint64_t size, VkBufferUsageFlags usage, const Memory& memory, uint64_t offset,
               const std::string& name)
    : device_(&device), size_(size == 0 ? 16 : size) {
  const VkBufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = size_, .usage = usage};
  checkAllocation(vmaCreateAliasingBuffer2(device.allocator(), memory.allocation(), offset, &info, &buffer_),
                  "vmaCreateAliasingBuffer2", name, size_);
  device.name(VK_OBJECT_TYPE_BUFFER, reinterpret_cast<uint64_t>(buffer_), name);
}

Buffer Buffer::borrowed(VkBuffer buffer, uint64_t size) {
  Buffer b;
  b.buffer_ = buffer;
  b.size_ = size;
  return b;
}

Buffer::~Buffer() {
  if (buffer_ && device_) vmaDestroyBuffer(device_->allocator(), buffer_, allocation_);
}

Buffer::Buffer(Buffer&& other) noexcept
    : device_(std::exchange(other.device_, {})),
      buffer_(std::exchange(other.buffer_, {})),
      allocation_(std::exchange(other.allocation_, {})),
      size_(std::exchange(other.size_, {})),
      address_(std::exchange(other.address_, {})),
      mapped_(std::exchange(other.mapped_, {})) {}

Buffer& Buffer::operator=(Buffer&& other) noexcept {
  if (this == &other) return *this;
  const Buffer old(std::move(*this));  // frees what was here at the end of this function
  std::swap(device_, other.device_);
  std::swap(buffer_, other.buffer_);
  std::swap(allocation_, other.allocation_);
  std::swap(size_, other.size_);
  std::swap(address_, other.address_);
  std::swap(mapped_, other.mapped_);
  return *this;
}

void Buffer::flush() const {
  check(vmaFlushAllocation(device_->allocator(), allocation_, 0, VK_WHOLE_SIZE), "vmaFlushAllocation");
}

void Buffer::invalidate() const {
  check(vmaInvalidateAllocation(device_->allocator(), allocation_, 0, VK_WHOLE_SIZE), "vmaInvalidateAllocation");
}

namespace {

VkImageCreateInfo createInfo(const ImageDesc& desc) {
  return {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
          .imageType = desc.type,
          .format = desc.format,
          .extent = {desc.width, desc.height, desc.depth},
          .mipLevels = desc.mipLevels,
          .arrayLayers = 1,
          .samples = VK_SAMPLE_COUNT_1_BIT,
          .tiling = VK_IMAGE_TILING_OPTIMAL,
          .usage = desc.usage};
}

/// Buffers and images may lie side by side only a page of the device's choice apart.
MemoryNeeds needsOf(const Device& device, const VkMemoryRequirements& asked) {
  VkPhysicalDeviceProperties properties;
  vkGetPhysicalDeviceProperties(device.physical(), &properties);
  const uint64_t page = std::max(asked.alignment, properties.limits.bufferImageGranularity);
  return {(asked.size + page - 1) / page * page, page, asked.memoryTypeBits};
}

}  // namespace

MemoryNeeds bufferNeeds(const Device& device, uint64_t size, VkBufferUsageFlags usage) {
  const VkBufferCreateInfo info{
      .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = size == 0 ? 16 : size, .usage = usage};
  const VkDeviceBufferMemoryRequirements ask{.sType = VK_STRUCTURE_TYPE_DEVICE_BUFFER_MEMORY_REQUIREMENTS,
                                             .pCreateInfo = &info};
  VkMemoryRequirements2 asked{.sType = VK_STRUCTURE_TYPE_MEMORY_REQUIREMENTS_2};
  vkGetDeviceBufferMemoryRequirements(device.handle(), &ask, &asked);
  return needsOf(device, asked.memoryRequirements);
}

MemoryNeeds imageNeeds(const Device& device, const ImageDesc& desc) {
  const VkImageCreateInfo info = createInfo(desc);
  const VkDeviceImageMemoryRequirements ask{.sType = VK_STRUCTURE_TYPE_DEVICE_IMAGE_MEMORY_REQUIREMENTS,
                                            .pCreateInfo = &info};
  VkMemoryRequirements2 asked{.sType = VK_STRUCTURE_TYPE_MEMORY_REQUIREMENTS_2};
  vkGetDeviceImageMemoryRequirements(device.handle(), &ask, &asked);
  return needsOf(device, asked.memoryRequirements);
}

Memory::Memory(const Device& device, const MemoryNeeds& needs, const std::string& name) : device_(&device) {
  const VkMemoryRequirements asked{needs.bytes, needs.alignment, needs.kinds};
  const VmaAllocationCreateInfo info{.requiredFlags = 0, .preferredFlags = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT};
  checkAllocation(vmaAllocateMemory(device.allocator(), &asked, &info, &allocation_, nullptr), "vmaAllocateMemory",
                  name, needs.bytes);
  vmaSetAllocationName(device.allocator(), allocation_, name.c_str());
}

Memory::~Memory() {
  if (allocation_) vmaFreeMemory(device_->allocator(), allocation_);
}

Memory::Memory(Memory&& other) noexcept
    : device_(std::exchange(other.device_, {})), allocation_(std::exchange(other.allocation_, {})) {}

Memory& Memory::operator=(Memory&& other) noexcept {
  std::swap(device_, other.device_);
  std::swap(allocation_, other.allocation_);
  return *this;
}

Image::Image(const Device& device, const ImageDesc& desc, const std::string& name) : device_(&device), desc_(desc) {
  const VkImageCreateInfo info = createInfo(desc);
  const VmaAllocationCreateInfo allocate = allocationFor(Residency::Device);
  VmaAllocationInfo allocated;
  checkAllocation(vmaCreateImage(device.allocator(), &info, &allocate, &image_, &allocation_, &allocated),
                  "vmaCreateImage", name, uint64_t{16} * desc.width * desc.height * desc.depth);
  bytes_ = allocated.size;
  vmaSetAllocationName(device.allocator(), allocation_, name.c_str());
  makeView(name);
}

Image::Image(const Device& device, const ImageDesc& desc, const Memory& memory, uint64_t offset,
             const std::string& name)
    : device_(&device), desc_(desc) {
  const VkImageCreateInfo info = createInfo(desc);
  checkAllocation(vmaCreateAliasingImage2(device.allocator(), memory.allocation(), offset, &info, &image_),
                  "vmaCreateAliasingImage2", name, uint64_t{16} * desc.width * desc.height * desc.depth);
  makeView(name);
}

Image Image::borrowed(VkImage image, VkImageView view, const ImageDesc& desc) {
  Image i;
  i.image_ = image;
  i.view_ = view;
  i.desc_ = desc;
  return i;
}

void Image::makeView(const std::string& name) {
  const VkImageViewType viewType = desc_.type == VK_IMAGE_TYPE_1D   ? VK_IMAGE_VIEW_TYPE_1D
                                   : desc_.type == VK_IMAGE_TYPE_3D ? VK_IMAGE_VIEW_TYPE_3D
                                                                    : VK_IMAGE_VIEW_TYPE_2D;
  const VkImageViewCreateInfo view{.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                   .image = image_,
                                   .viewType = viewType,
                                   .format = desc_.format,
                                   .subresourceRange = {aspect(), 0, desc_.mipLevels, 0, 1}};
  // An image that is only copied from and to may not have a view.
  constexpr VkImageUsageFlags kViewable =
      VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT |
      VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_INPUT_ATTACHMENT_BIT;
  if (desc_.usage & kViewable) {
    const VkResult result = vkCreateImageView(device_->handle(), &view, nullptr, &view_);
    if (result != VK_SUCCESS) vmaDestroyImage(device_->allocator(), image_, allocation_);
    check(result, "vkCreateImageView");
  }
  device_->name(VK_OBJECT_TYPE_IMAGE, reinterpret_cast<uint64_t>(image_), name);
  device_->name(VK_OBJECT_TYPE_IMAGE_VIEW, reinterpret_cast<uint64_t>(view_), name);
}

Image::~Image() {
  if (!device_) return;  // nothing, or borrowed
  if (view_) vkDestroyImageView(device_->handle(), view_, nullptr);
  if (image_) vmaDestroyImage(device_->allocator(), image_, allocation_);
}

Image::Image(Image&& other) noexcept
    : device_(std::exchange(other.device_, {})),
      image_(std::exchange(other.image_, {})),
      view_(std::exchange(other.view_, {})),
      allocation_(std::exchange(other.allocation_, {})),
      desc_(std::exchange(other.desc_, {})),
      bytes_(std::exchange(other.bytes_, {})) {}

Image& Image::operator=(Image&& other) noexcept {
  if (this == &other) return *this;
  const Image old(std::move(*this));  // frees what was here at the end of this function
  std::swap(device_, other.device_);
  std::swap(image_, other.image_);
  std::swap(view_, other.view_);
  std::swap(allocation_, other.allocation_);
  std::swap(desc_, other.desc_);
  std::swap(bytes_, other.bytes_);
  return *this;
}

VkImageAspectFlags Image::aspect() const {
  switch (desc_.format) {
    case VK_FORMAT_D16_UNORM:
    case VK_FORMAT_X8_D24_UNORM_PACK32:
    case VK_FORMAT_D32_SFLOAT:
      return VK_IMAGE_ASPECT_DEPTH_BIT;
    case VK_FORMAT_S8_UINT:
      return VK_IMAGE_ASPECT_STENCIL_BIT;
    case VK_FORMAT_D16_UNORM_S8_UINT:
    case VK_FORMAT_D24_UNORM_S8_UINT:
    case VK_FORMAT_D32_SFLOAT_S8_UINT:
      return VK_IMAGE_ASPECT_DEPTH_BIT | VK_IMAGE_ASPECT_STENCIL_BIT;
    default:
      return VK_IMAGE_ASPECT_COLOR_BIT;
  }
}

Buffer uploadBuffer(const Device& device, std::span<const std::byte> bytes, VkBufferUsageFlags usage,
                    const std::string& name) {
  Buffer buffer(device, bytes.size(), usage | VK_BUFFER_USAGE_TRANSFER_DST_BIT, Residency::Device, name);
  if (bytes.empty()) return buffer;
  Buffer staging(device, bytes.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, Residency::Upload, name + " (staging)");
  std::memcpy(staging.mapped(), bytes.data(), bytes.size());
  staging.flush();
  device.submitAndWait([&](VkCommandBuffer commands) {
    const VkBufferCopy region{.size = bytes.size()};
    vkCmdCopyBuffer(commands, staging.handle(), buffer.handle(), 1, &region);
    fullBarrier(commands);
  });
  return buffer;
}

Image uploadImage(const Device& device, ImageDesc desc, std::span<const std::byte> texels, const std::string& name) {
  return uploadImage(device, desc, texels, {}, name);
}

Image uploadImage(const Device& device, ImageDesc desc, std::span<const std::byte> texels,
                  std::span<const std::byte> levels, const std::string& name) {
  desc.usage |= VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_SAMPLED_BIT;
  Image image(device, desc, name);
  Buffer staging(device, texels.size() + levels.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, Residency::Upload,
                 name + " (staging)");
  std::ranges::copy(texels, staging.mapped());
  std::ranges::copy(levels, staging.mapped() + texels.size());
  staging.flush();
  std::vector<VkBufferImageCopy> regions;
  const uint64_t texel = texels.size() / (uint64_t{desc.width} * desc.height * desc.depth);
  uint64_t offset = 0;
  for (uint32_t level = 0; level == 0 || (level < desc.mipLevels && !levels.empty()); ++level) {
    const VkExtent3D extent{std::max(1u, desc.width >> level), std::max(1u, desc.height >> level),
                            std::max(1u, desc.depth >> level)};
    regions.push_back(
        {.bufferOffset = offset, .imageSubresource = {image.aspect(), level, 0, 1}, .imageExtent = extent});
    offset += texel * extent.width * extent.height * extent.depth;
  }
  device.submitAndWait([&](VkCommandBuffer commands) {
    transition(commands, image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    vkCmdCopyBufferToImage(commands, staging.handle(), image.handle(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                           static_cast<uint32_t>(regions.size()), regions.data());
    transition(commands, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
  });
  return image;
}

std::vector<std::byte> readBuffer(const Device& device, const Buffer& buffer) {
  Buffer staging(device, buffer.size(), VK_BUFFER_USAGE_TRANSFER_DST_BIT, Residency::Readback, "readback");
  device.submitAndWait([&](VkCommandBuffer commands) {
    fullBarrier(commands);
    const VkBufferCopy region{.size = buffer.size()};
    vkCmdCopyBuffer(commands, buffer.handle(), staging.handle(), 1, &region);
    fullBarrier(commands);
  });
  staging.invalidate();
  return {staging.mapped(), staging.mapped() + buffer.size()};
}

uint64_t freeDeviceBytes(const Device& device) {
  const VkPhysicalDeviceMemoryProperties* memory = nullptr;
  vmaGetMemoryProperties(device.allocator(), &memory);
  std::array<VmaBudget, VK_MAX_MEMORY_HEAPS> budgets{};
  vmaGetHeapBudgets(device.allocator(), budgets.data());
  uint64_t most = 0;
  for (uint32_t heap = 0; heap < memory->memoryHeapCount; ++heap) {
    if ((memory->memoryHeaps[heap].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) == 0) continue;
    const VmaBudget& b = budgets[heap];
    if (b.budget > b.usage) most = std::max<uint64_t>(most, b.budget - b.usage);
  }
  return most;
}

void fullBarrier(VkCommandBuffer commands) {
  const VkMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                 .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                 .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
                                 .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_2_HOST_BIT,
                                 .dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT};
  const VkDependencyInfo dependency{
      .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &barrier};
  vkCmdPipelineBarrier2(commands, &dependency);
}

}  // namespace weir::gpu
