#include "view/compare/file_reference.h"

#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/render/reference_picture.h>

#include <cstring>
#include <filesystem>
#include <limits>
#include <utility>

namespace weir::view {

FileReference::FileReference(const gpu::Device& device, const std::string& file, const render::Stage& stage,
                             const std::string& animation, uint32_t width, uint32_t height)
    : file_(file), width_(width), height_(height) {
  ReferencePicture reference;
  reference.picture = render::readRadiance(file);
  reference.view = 1;
  reference.relMse = std::numeric_limits<double>::quiet_NaN();
  try {
    render::requireSameSubject(stage, animation, file, reference.picture);
  } catch (const InputError& error) {
    subject_ = error.what();
  }
  picture_ = std::make_shared<const ReferencePicture>(std::move(reference));
  upload(device);
}

void FileReference::upload(const gpu::Device& device) {
  const image::Picture& picture = picture_->picture;
  VkPhysicalDeviceProperties properties{};
  vkGetPhysicalDeviceProperties(device.physical(), &properties);
  const uint32_t most = properties.limits.maxImageDimension2D;
  if (picture.width > most || picture.height > most)
    throw InputError(fmt::format("'{}' is {}x{} pixels: images of this device have at most {} a side", file_,
                                 picture.width, picture.height, most));
  resource_.name = "reference.mean";
  resource_.type = storageImage(Format::RGBA32F);
  resource_.width = picture.width;
  resource_.height = picture.height;
  resource_.bytes = picture.rgba.size() * sizeof(float);
  storage_.image = gpu::Image(device, execute::imageDesc(device, resource_), resource_.name);
  const gpu::Buffer staging(device, resource_.bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, gpu::Residency::Upload,
                            "reference upload");
  std::memcpy(staging.mapped(), picture.rgba.data(), resource_.bytes);
  staging.flush();
  device.submitAndWait([&](VkCommandBuffer commands) {
    const VkImageMemoryBarrier2 start = execute::toGeneral(storage_.image);
    VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    info.imageMemoryBarrierCount = 1;
    info.pImageMemoryBarriers = &start;
    vkCmdPipelineBarrier2(commands, &info);
    gpu::fullBarrier(commands);
    VkBufferImageCopy copy{};
    copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    copy.imageExtent = {picture.width, picture.height, 1};
    vkCmdCopyBufferToImage(commands, staging.handle(), storage_.image.handle(), VK_IMAGE_LAYOUT_GENERAL, 1, &copy);
    gpu::fullBarrier(commands);
  });
}

void FileReference::restart(const execute::FrameInput& /*shown*/, uint32_t width, uint32_t height) {
  moved_ = true;
  width_ = width;
  height_ = height;
}

std::string FileReference::words() const {
  const image::Picture& picture = picture_->picture;
  return fmt::format("{}, {}x{}: {}", std::filesystem::path(file_).filename().string(), picture.width, picture.height,
                     qualityInWords(*picture_));
}

std::string FileReference::warning() const {
  std::string text = subject_;
  const auto add = [&](const std::string& line) { text += (text.empty() ? "" : "\n") + line; };
  const image::Picture& picture = picture_->picture;
  if (picture.width != width_ || picture.height != height_)
    add(fmt::format("'{}' is {}x{} pixels and {}x{} are shown: no error can be told", file_, picture.width,
                    picture.height, width_, height_));
  if (moved_) add("what is shown has changed since the file was opened");
  return text;
}

}  // namespace weir::view
