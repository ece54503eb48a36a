#include "view/compare/picture_ring.h"

#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/gpu/barrier.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <glm/gtc/packing.hpp>

#include "view/compare/submission.h"

namespace weir::view {
namespace {

template <typename T>
T load(const std::byte* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

void unpackPixel(const std::byte* from, Format format, float* to) {
  to[0] = to[1] = to[2] = 0.0f;
  to[3] = 1.0f;
  switch (format) {
    case Format::R32F:
      to[0] = to[1] = to[2] = load<float>(from);
      break;
    case Format::RG32F:
      std::memcpy(to, from, 8);
      break;
    case Format::RGBA32F:
      std::memcpy(to, from, 16);
      break;
    case Format::RGBA16F:
      for (int c = 0; c < 4; ++c) to[c] = glm::unpackHalf1x16(load<uint16_t>(from + 2 * c));
      break;
    case Format::RGBA8:
      for (int c = 0; c < 4; ++c) to[c] = static_cast<float>(load<uint8_t>(from + c)) / 255.0f;
      break;
    case Format::R32U:
      to[0] = to[1] = to[2] = static_cast<float>(load<uint32_t>(from));
      break;
  }
}

}  // namespace

image::Picture HostCopy::picture() const {
  image::Picture picture;
  picture.width = width_;
  picture.height = height_;
  const size_t pixels = size_t{width_} * height_;
  picture.rgba.resize(4 * pixels);
  const std::byte* from = bytes_->mapped();
  if (format_ == Format::RGBA32F) {  // as it is
    std::memcpy(picture.rgba.data(), from, 16 * pixels);
    return picture;
  }
  const size_t texel = formatBytes(format_);
  for (size_t i = 0; i < pixels; ++i) unpackPixel(from + i * texel, format_, &picture.rgba[4 * i]);
  return picture;
}

struct PictureRing::Slot {
  explicit Slot(const gpu::Device& device) : submission(device, "picture to the host") {}
  HostCopy copy;  ///< on its way; its buffer is lent out while others share it
  bool onTheWay = false;
  uint64_t turn = 0;
  Submission submission;  ///< last, so that it waits before the buffer goes
  bool free() const { return !onTheWay && copy.bytes_.use_count() <= 1; }
};

PictureRing::PictureRing(const gpu::Device& device, size_t most) : device_(device), most_(most) {}
PictureRing::~PictureRing() = default;

PictureRing::Slot* PictureRing::freeSlot() {
  for (const std::unique_ptr<Slot>& slot : slots_) {
    if (!slot->free()) continue;
    std::atomic_thread_fence(std::memory_order_acquire);  // whoever had it has read it
    return slot.get();
  }
  if (slots_.size() == most_) return nullptr;
  return slots_.emplace_back(std::make_unique<Slot>(device_)).get();
}

bool PictureRing::capture(const execute::Executor::Located& image, uint64_t number) {
  if (image.resource == nullptr || !image.resource->isImage())
    throw InputError(fmt::format("'{}' is a buffer, not a picture", image.resource ? image.resource->name : ""));
  Slot* slot = freeSlot();
  if (slot == nullptr) return false;
  const graph::Resource& resource = *image.resource;
  const uint64_t bytes = uint64_t{resource.width} * resource.height * formatBytes(resource.type.format);
  HostCopy& copy = slot->copy;
  if (!copy.bytes_ || copy.bytes_->size() != bytes)
    copy.bytes_ = std::make_shared<gpu::Buffer>(device_, bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                                gpu::Residency::Readback, "picture to the host");
  copy.format_ = resource.type.format;
  copy.width_ = resource.width;
  copy.height_ = resource.height;
  copy.number_ = number;

  constexpr VkPipelineStageFlags2 kCopy = VK_PIPELINE_STAGE_2_COPY_BIT, kAll = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  VkCommandBuffer commands = slot->submission.begin();
  gpu::memoryBarrier(commands, kAll, VK_ACCESS_2_MEMORY_WRITE_BIT, kCopy, VK_ACCESS_2_TRANSFER_READ_BIT);
  VkBufferImageCopy region{};
  region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  region.imageExtent = {resource.width, resource.height, 1};
  vkCmdCopyImageToBuffer(commands, image.storage->image.handle(), VK_IMAGE_LAYOUT_GENERAL, copy.bytes_->handle(), 1,
                         &region);
  // The host reads the copy; what comes later overwrites the image.
  gpu::memoryBarrier(commands, kCopy, VK_ACCESS_2_TRANSFER_WRITE_BIT, kAll | VK_PIPELINE_STAGE_2_HOST_BIT,
                     VK_ACCESS_2_HOST_READ_BIT);
  slot->submission.submit();
  slot->onTheWay = true;
  slot->turn = captured_++;
  return true;
}

std::vector<HostCopy> PictureRing::take() {
  std::vector<Slot*> done;
  for (const std::unique_ptr<Slot>& slot : slots_)
    if (slot->onTheWay && slot->submission.done()) done.push_back(slot.get());
  std::ranges::sort(done, {}, &Slot::turn);
  std::vector<HostCopy> copies;
  for (Slot* slot : done) {
    slot->copy.bytes_->invalidate();
    slot->onTheWay = false;
    copies.push_back(slot->copy);
  }
  return copies;
}

bool PictureRing::pending() const {
  return std::ranges::any_of(slots_, [](const std::unique_ptr<Slot>& slot) { return slot->onTheWay; });
}

}  // namespace weir::view
