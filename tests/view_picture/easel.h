// A canvas on the tests' device, ports made of bytes, and what is drawn of them brought back.
#pragma once

#include <gtest/gtest.h>
#include <weir/image/image.h>
#include <weir/pass/description.h>

#include <array>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "support/device.h"
#include "view/picture/port_picture.h"
#include "view/picture/range_meter.h"

namespace weir::test {

using Rgb = std::array<int, 3>;

/// A port that holds given bytes.
struct FilledPort {
  execute::Storage storage;
  graph::Resource resource;
  operator view::Port() const { return {storage, resource}; }  // NOLINT(google-explicit-constructor)
};

class Easel {
 public:
  static constexpr uint32_t kSide = 64;
  explicit Easel(std::shared_ptr<gpu::Device> device = validatedDevice())
      : device_(std::move(device)), guard_(*device_), picture_(*device_, compiler_), meter_(*device_, compiler_) {
    gpu::ImageDesc desc;
    desc.width = desc.height = kSide;
    desc.usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    canvas_ = gpu::Image(*device_, desc, "canvas");
    device_->submitAndWait([&](VkCommandBuffer commands) { start(commands, canvas_); });
  }

  gpu::Device& device() { return *device_; }
  shader::Compiler& compiler() { return compiler_; }
  view::PortPicture& picture() { return picture_; }
  view::RangeMeter& meter() { return meter_; }
  view::Canvas canvas() const { return {canvas_.view(), kSide, kSide}; }

  template <typename T>
  FilledPort image(Format format, uint32_t width, uint32_t height, const std::vector<T>& texels) {
    FilledPort port;
    port.resource.name = "test.image";
    port.resource.type = storageImage(format);
    port.resource.width = width;
    port.resource.height = height;
    port.resource.bytes = uint64_t{width} * height * formatBytes(format);
    EXPECT_EQ(port.resource.bytes, texels.size() * sizeof(T));
    port.storage.image = gpu::Image(*device_, execute::imageDesc(*device_, port.resource), "image");
    const gpu::Buffer staging = upload(std::as_bytes(std::span(texels)));
    device_->submitAndWait([&](VkCommandBuffer commands) {
      start(commands, port.storage.image);
      VkBufferImageCopy copy{};
      copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
      copy.imageExtent = {width, height, 1};
      vkCmdCopyBufferToImage(commands, staging.handle(), port.storage.image.handle(), VK_IMAGE_LAYOUT_GENERAL, 1,
                             &copy);
      gpu::fullBarrier(commands);
    });
    return port;
  }

  /// `fixed`: a buffer without pixels.
  template <typename T>
  FilledPort buffer(const Layout& layout, uint32_t width, uint32_t height, uint32_t perPixel,
                    const std::vector<T>& values, bool fixed = false) {
    FilledPort port;
    port.resource.name = "test.buffer";
    port.resource.type.layout = layout;
    port.resource.bytes = values.size() * sizeof(T);
    port.resource.elements = port.resource.bytes / layout.stride;
    port.resource.type.fixedCount = fixed ? static_cast<uint32_t>(port.resource.elements) : 0;
    port.resource.width = fixed ? 0 : width;
    port.resource.height = fixed ? 0 : height;
    port.resource.perPixel = perPixel;
    port.storage.buffer = gpu::uploadBuffer(
        *device_, values, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT, "port");
    return port;
  }

  /// The whole canvas as a target: the port's pixels at the top left corner, one for one.
  view::Target plainTarget() const { return {.canvas = canvas(), .placement = {}, .clip = {0, 0, kSide, kSide}}; }

  void draw(const view::Shown& shown, const view::PictureMode& mode, const view::Target& target) {
    picture_.begin(0);
    device_->submitAndWait([&](VkCommandBuffer commands) { picture_.draw(commands, shown, mode, target); });
  }
  void draw(const view::Port& port, const view::Channel& channel, const view::PictureMode& mode) {
    draw({port, channel}, mode, plainTarget());
  }

  /// What the canvas shows, RGBA8 by rows.
  std::vector<uint8_t> pixels() {
    const gpu::Buffer staging(*device_, uint64_t{4} * kSide * kSide, VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                              gpu::Residency::Readback, "canvas");
    device_->submitAndWait([&](VkCommandBuffer commands) {
      gpu::fullBarrier(commands);
      VkBufferImageCopy copy{};
      copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
      copy.imageExtent = {kSide, kSide, 1};
      vkCmdCopyImageToBuffer(commands, canvas_.handle(), VK_IMAGE_LAYOUT_GENERAL, staging.handle(), 1, &copy);
      gpu::fullBarrier(commands);
    });
    staging.invalidate();
    std::vector<uint8_t> all(size_t{4} * kSide * kSide);
    std::memcpy(all.data(), staging.mapped(), all.size());
    return all;
  }

  static Rgb at(const std::vector<uint8_t>& pixels, uint32_t x, uint32_t y) {
    const uint8_t* p = &pixels[4 * (size_t{y} * kSide + x)];
    return {p[0], p[1], p[2]};
  }

  /// Every value of a channel, row by row; of ports no larger than RangeMeter::kCells each way.
  std::vector<view::RangeMeter::Cell> values(const view::Shown& shown, uint32_t element = 0) {
    device_->submitAndWait([&](VkCommandBuffer commands) { meter_.record(commands, 0, shown, element); });
    return meter_.cells(0);
  }

 private:
  static void start(VkCommandBuffer commands, const gpu::Image& image) {
    const VkImageMemoryBarrier2 barrier = execute::toGeneral(image);
    VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    info.imageMemoryBarrierCount = 1;
    info.pImageMemoryBarriers = &barrier;
    vkCmdPipelineBarrier2(commands, &info);
  }
  gpu::Buffer upload(std::span<const std::byte> bytes) {
    gpu::Buffer staging(*device_, bytes.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, gpu::Residency::Upload, "texels");
    std::memcpy(staging.mapped(), bytes.data(), bytes.size());
    staging.flush();
    return staging;
  }

  std::shared_ptr<gpu::Device> device_;
  ExpectNoValidationMessages guard_;
  shader::Compiler compiler_;
  view::PortPicture picture_;
  view::RangeMeter meter_;
  gpu::Image canvas_;
};

/// The channel of that name of a port; fails the test where there is none.
inline view::Channel channelNamed(const graph::Resource& resource, const std::string& name,
                                  Meaning meaning = Meaning::Data, bool f90 = false) {
  const std::vector<view::Channel> all = view::channelsOf(resource, meaning, f90);
  const view::Channel* found = view::findChannel(all, name);
  EXPECT_NE(found, nullptr) << name;
  return found != nullptr ? *found : view::Channel{};
}

/// What an 8-bit screen shows of a value in [0, 1].
inline int byteOf(double v) {
  return static_cast<int>(std::min(255.0, std::max(v, 0.0) * 255.0 + 0.5));
}

/// IEC 61966-2-1.
inline double srgbOf(double linear) {
  const double v = std::min(std::max(linear, 0.0), 1.0);
  return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055;
}

/// Equal but for the last code, where the device's rounding and powers may differ.
inline void expectNear(const Rgb& is, const Rgb& wanted, const std::string& what) {
  for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(is[c], wanted[c], 1) << what << ", colour " << c;
}

}  // namespace weir::test
