#include "view/compare/accumulator.h"

#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/gpu/barrier.h>
#include <weir/image/metrics.h>

#include <array>

#include "view/picture/kernels.h"

namespace weir::view {
namespace {

constexpr uint64_t kBytesPerPixel = 48;  // Sums in accumulate.glsl

struct Push {
  uint32_t width, height, count;
  float epsilon;
};

}  // namespace

Accumulator::Accumulator(const gpu::Device& device, shader::Compiler& compiler, uint32_t width, uint32_t height,
                         uint32_t sets)
    : width_(width), height_(height) {
  const uint64_t bytes = kBytesPerPixel * width * height, most = device.capabilities().maxStorageBufferRange;
  if (bytes > most)
    throw InputError(fmt::format("a mean of {}x{} pixels takes a buffer of {} bytes: this device's shaders see {}",
                                 width, height, bytes, most));
  execute::ToolKernelOptions options;
  options.name = "accumulate the reference";
  options.file = viewShader("accumulate.glsl");
  options.images = {true, false, true};
  options.pushBytes = sizeof(Push);
  options.sets = sets;
  kernel_ = std::make_unique<execute::ToolKernel>(device, compiler, options);
  sums_ = gpu::Buffer(device, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Residency::Device, "reference sums");
  resource_.name = "reference.mean";
  resource_.type = storageImage(Format::RGBA32F);
  resource_.width = width;
  resource_.height = height;
  resource_.bytes = uint64_t{16} * width * height;
  mean_.image = gpu::Image(device, execute::imageDesc(device, resource_), resource_.name);
  device.submitAndWait([&](VkCommandBuffer commands) {
    const VkImageMemoryBarrier2 start = execute::toGeneral(mean_.image);
    VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    info.imageMemoryBarrierCount = 1;
    info.pImageMemoryBarriers = &start;
    vkCmdPipelineBarrier2(commands, &info);
    gpu::fullBarrier(commands);
    // Somebody may show it before there is a frame.
    execute::clear(commands, mean_, resource_.type);
    gpu::fullBarrier(commands);
  });
}

void Accumulator::record(VkCommandBuffer commands, uint32_t set, const execute::Storage& frame, uint32_t count) const {
  constexpr VkPipelineStageFlags2 kCompute = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                                  kAll = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  constexpr VkAccessFlags2 kUse = VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
  gpu::memoryBarrier(commands, kAll, VK_ACCESS_2_MEMORY_WRITE_BIT, kCompute, kUse);
  const Push push{width_, height_, count, static_cast<float>(image::kRelMseEpsilon)};
  const std::array<execute::ToolBinding, 3> bindings{
      {{VK_NULL_HANDLE, frame.image.view()}, {sums_.handle(), VK_NULL_HANDLE}, {VK_NULL_HANDLE, mean_.image.view()}}};
  kernel_->record(commands, set, bindings, std::as_bytes(std::span(&push, 1)), width_, height_);
  gpu::memoryBarrier(commands, kCompute, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT, kAll,
                     VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT);
}

}  // namespace weir::view
