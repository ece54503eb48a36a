#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/scene/upload_environment.h>

#include <cstring>
#include <span>
#include <utility>

namespace weir::scene {
namespace {

void checkSize(const gpu::Device& device, const Environment& environment) {
  VkPhysicalDeviceProperties properties{};
  vkGetPhysicalDeviceProperties(device.physical(), &properties);
  const uint32_t most = properties.limits.maxImageDimension2D;
  if (environment.width > most || environment.height > most) {
    throw InputError(fmt::format("environment '{}' is {}x{} texels; this device takes {} a side at most",
                                 environment.path, environment.width, environment.height, most));
  }
}

std::vector<std::byte> tableBytes(const Environment& environment, const EnvironmentTable& table) {
  const GpuEnvironment head{table.columns,      table.rows,       table.block,         environment.width,
                            environment.height, environment.unit, environment.rotation};
  const auto cells = std::as_bytes(std::span(table.cells));
  std::vector<std::byte> bytes(sizeof head + cells.size());
  std::memcpy(bytes.data(), &head, sizeof head);
  std::memcpy(bytes.data() + sizeof head, cells.data(), cells.size());
  return bytes;
}

}  // namespace

EnvironmentGpu::EnvironmentGpu(const gpu::Device& device, const Environment& environment, const EnvironmentTable& table)
    : device_(&device) {
  checkSize(device, environment);
  table_ = gpu::uploadBuffer(device, tableBytes(environment, table), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                             "environment table");
  gpu::ImageDesc desc;
  desc.width = environment.width;
  desc.height = environment.height;
  desc.format = VK_FORMAT_R16G16B16A16_SFLOAT;
  map_ = gpu::uploadImage(device, desc, std::as_bytes(std::span(environment.texels)), "environment");
  VkSamplerCreateInfo info{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  info.magFilter = info.minFilter = VK_FILTER_LINEAR;
  info.addressModeU = VK_SAMPLER_ADDRESS_MODE_REPEAT;  // round the seam
  info.addressModeV = info.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  gpu::check(vkCreateSampler(device.handle(), &info, nullptr, &sampler_), "vkCreateSampler");
}

EnvironmentGpu::~EnvironmentGpu() {
  if (sampler_ != VK_NULL_HANDLE) vkDestroySampler(device_->handle(), sampler_, nullptr);
}

EnvironmentGpu::EnvironmentGpu(EnvironmentGpu&& other) noexcept
    : device_(other.device_),
      table_(std::move(other.table_)),
      map_(std::move(other.map_)),
      sampler_(std::exchange(other.sampler_, VK_NULL_HANDLE)) {}

EnvironmentGpu& EnvironmentGpu::operator=(EnvironmentGpu&& other) noexcept {
  std::swap(device_, other.device_);
  std::swap(table_, other.table_);
  std::swap(map_, other.map_);
  std::swap(sampler_, other.sampler_);
  return *this;
}

VkDescriptorImageInfo EnvironmentGpu::map() const {
  return {sampler_, map_.view(), VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
}

}  // namespace weir::scene
