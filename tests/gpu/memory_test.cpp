// Buffers and images: their bytes arrive, come back, and are freed.
#include <gtest/gtest.h>
#include <weir/core/error.h>
#include <weir/gpu/memory.h>

#include <cstring>
#include <numeric>

#include "support/device.h"

namespace weir::gpu {
namespace {

class Memory : public ::testing::Test {
 protected:
  std::shared_ptr<Device> device_ = test::validatedDevice();
  test::ExpectNoValidationMessages guard_{*device_};
};

TEST_F(Memory, EmptyBufferIsStillABuffer) {
  const Buffer buffer(*device_, 0, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, Residency::Device, "empty");
  EXPECT_TRUE(buffer);
  EXPECT_EQ(buffer.size(), 16u);
  EXPECT_EQ(buffer.mapped(), nullptr);
  EXPECT_EQ(buffer.address(), 0u);
  EXPECT_TRUE(uploadBuffer(*device_, std::span<const std::byte>(), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, "none"));
}

TEST_F(Memory, AddressIsAlignedAsAsked) {
  constexpr VkBufferUsageFlags kUsage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;
  std::vector<Buffer> buffers;
  for (uint64_t alignment : {0, 16, 256, 4096}) {
    buffers.emplace_back(*device_, 100, kUsage, Residency::Device, "aligned", alignment);
    ASSERT_NE(buffers.back().address(), 0u);
    EXPECT_EQ(buffers.back().address() % std::max<uint64_t>(alignment, 1), 0u);
  }
}

TEST_F(Memory, UploadAndReadbackAreMapped) {
  const Buffer upload(*device_, 256, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, Residency::Upload, "upload");
  const Buffer readback(*device_, 256, VK_BUFFER_USAGE_TRANSFER_DST_BIT, Residency::Readback, "readback");
  ASSERT_NE(upload.mapped(), nullptr);
  ASSERT_NE(readback.mapped(), nullptr);
  for (int i = 0; i < 256; ++i) upload.mapped()[i] = static_cast<std::byte>(i);
  upload.flush();
  device_->submitAndWait([&](VkCommandBuffer commands) {
    const VkBufferCopy region{.size = 256};
    vkCmdCopyBuffer(commands, upload.handle(), readback.handle(), 1, &region);
    fullBarrier(commands);
  });
  readback.invalidate();
  for (int i = 0; i < 256; ++i) ASSERT_EQ(readback.mapped()[i], static_cast<std::byte>(i));
}

TEST_F(Memory, MovingLeavesNothingBehindAndFreesAtOnce) {
  Buffer a(*device_, 64, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, Residency::Device, "a");
  const VkBuffer handle = a.handle();
  Buffer b = std::move(a);
  EXPECT_FALSE(a);
  EXPECT_EQ(a.size(), 0u);
  EXPECT_EQ(b.handle(), handle);
  Buffer c(*device_, 64, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, Residency::Device, "c");
  c = std::move(b);
  EXPECT_FALSE(b) << "the old buffer was kept alive by the one that was moved from";
  EXPECT_EQ(c.handle(), handle);
  c = Buffer();
  EXPECT_FALSE(c);

  Image image(*device_, {.width = 4, .height = 4, .usage = VK_IMAGE_USAGE_STORAGE_BIT}, "image");
  Image other = std::move(image);
  EXPECT_FALSE(image);
  EXPECT_TRUE(other);
  EXPECT_NE(other.view(), VK_NULL_HANDLE);
  EXPECT_GE(other.bytes(), 64u);
}

TEST_F(Memory, ImageTexelsArrive) {
  constexpr uint32_t kWidth = 7, kHeight = 5;
  std::vector<float> texels(kWidth * kHeight * 4);
  std::iota(texels.begin(), texels.end(), 0.5f);
  const Image image = uploadImage(*device_,
                                  {.width = kWidth,
                                   .height = kHeight,
                                   .format = VK_FORMAT_R32G32B32A32_SFLOAT,
                                   .usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT},
                                  std::as_bytes(std::span(texels)), "texels");
  const uint64_t size = texels.size() * sizeof(float);
  const Buffer back(*device_, size, VK_BUFFER_USAGE_TRANSFER_DST_BIT, Residency::Readback, "back");
  device_->submitAndWait([&](VkCommandBuffer commands) {
    const VkImageMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
                                        .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                        .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
                                        .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                        .dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT,
                                        .oldLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                                        .newLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                        .image = image.handle(),
                                        .subresourceRange = {image.aspect(), 0, 1, 0, 1}};
    const VkDependencyInfo dependency{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .imageMemoryBarrierCount = 1, .pImageMemoryBarriers = &barrier};
    vkCmdPipelineBarrier2(commands, &dependency);
    const VkBufferImageCopy region{.imageSubresource = {image.aspect(), 0, 0, 1}, .imageExtent = {kWidth, kHeight, 1}};
    vkCmdCopyImageToBuffer(commands, image.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, back.handle(), 1, &region);
    fullBarrier(commands);
  });
  back.invalidate();
  EXPECT_EQ(std::memcmp(back.mapped(), texels.data(), size), 0);
}

TEST_F(Memory, AspectFollowsTheFormat) {
  const auto aspect = [&](VkFormat format, VkImageUsageFlags usage) {
    return Image(*device_, {.width = 4, .height = 4, .format = format, .usage = usage}, "aspect").aspect();
  };
  EXPECT_EQ(aspect(VK_FORMAT_D32_SFLOAT, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT),
            static_cast<VkImageAspectFlags>(VK_IMAGE_ASPECT_DEPTH_BIT));
  EXPECT_EQ(aspect(VK_FORMAT_R16G16_SFLOAT, VK_IMAGE_USAGE_STORAGE_BIT),
            static_cast<VkImageAspectFlags>(VK_IMAGE_ASPECT_COLOR_BIT));
}

TEST_F(Memory, MipsAndVolumesGetTheirView) {
  EXPECT_NE(
      Image(*device_, {.width = 8, .height = 8, .mipLevels = 4, .usage = VK_IMAGE_USAGE_SAMPLED_BIT}, "mips").view(),
      VK_NULL_HANDLE);
  EXPECT_NE(Image(*device_,
                  {.width = 4, .height = 4, .depth = 4, .usage = VK_IMAGE_USAGE_SAMPLED_BIT, .type = VK_IMAGE_TYPE_3D},
                  "volume")
                .view(),
            VK_NULL_HANDLE);
}

TEST(MemoryWithoutValidation, TooMuchIsAnErrorThatNamesTheBuffer) {
  const Device device({.choice = test::deviceChoice(), .cacheFolder = "-"});
  try {
    const Buffer buffer(device, uint64_t{1} << 50, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, Residency::Device, "petabyte");
    FAIL() << "a petabyte was allocated";
  } catch (const RuntimeError& error) {
    EXPECT_NE(std::string(error.what()).find("petabyte"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace weir::gpu
