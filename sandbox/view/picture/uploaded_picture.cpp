#include "view/picture/uploaded_picture.h"

#include <fmt/format.h>
#include <weir/core/error.h>

#include <cstring>

namespace weir::view {

UploadedPicture::UploadedPicture(const gpu::Device& device, const image::Picture& picture, const std::string& name) {
  VkPhysicalDeviceProperties properties;
  vkGetPhysicalDeviceProperties(device.physical(), &properties);
  const uint32_t side = properties.limits.maxImageDimension2D;
  const uint64_t pixels = uint64_t{picture.width} * picture.height;
  if (pixels == 0 || picture.width > side || picture.height > side || picture.rgba.size() != 4 * pixels)
    throw InputError(fmt::format("'{}' can't be shown: {}x{} pixels of {} values; from 1 to {} each way", name,
                                 picture.width, picture.height, picture.rgba.size(), side));
  resource_.name = name;
  resource_.type = storageImage(Format::RGBA32F);
  resource_.width = picture.width;
  resource_.height = picture.height;
  resource_.bytes = 16 * pixels;
  storage_.image = gpu::Image(device, execute::imageDesc(device, resource_), name);

  const gpu::Buffer staging(device, resource_.bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, gpu::Residency::Upload,
                            "upload");
  std::memcpy(staging.mapped(), picture.rgba.data(), resource_.bytes);
  staging.flush();
  device.submitAndWait([&](VkCommandBuffer commands) {
    const VkImageMemoryBarrier2 start = execute::toGeneral(storage_.image);
    VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    info.imageMemoryBarrierCount = 1;
    info.pImageMemoryBarriers = &start;
    vkCmdPipelineBarrier2(commands, &info);
    VkBufferImageCopy copy{};
    copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    copy.imageExtent = {picture.width, picture.height, 1};
    vkCmdCopyBufferToImage(commands, staging.handle(), storage_.image.handle(), VK_IMAGE_LAYOUT_GENERAL, 1, &copy);
    gpu::fullBarrier(commands);
  });
}

}  // namespace weir::view
