// An environment on the device: its picture and the table that picks from it. Internal to scene/upload.
#pragma once

#include <weir/gpu/memory.h>
#include <weir/scene/environment.h>

namespace weir::scene {

class EnvironmentGpu {
 public:
  EnvironmentGpu() = default;
  /// Uploads and waits. Throws InputError when the device takes no picture of that size.
  EnvironmentGpu(const gpu::Device& device, const Environment& environment, const EnvironmentTable& table);
  ~EnvironmentGpu();
  EnvironmentGpu(EnvironmentGpu&& other) noexcept;
  EnvironmentGpu& operator=(EnvironmentGpu&& other) noexcept;

  explicit operator bool() const { return sampler_ != VK_NULL_HANDLE; }
  VkBuffer table() const { return table_.handle(); }
  VkDescriptorImageInfo map() const;
  uint64_t bytes() const { return table_.size() + map_.bytes(); }

 private:
  const gpu::Device* device_ = nullptr;
  gpu::Buffer table_;  // GpuEnvironment, then the cells
  gpu::Image map_;
  VkSampler sampler_ = VK_NULL_HANDLE;
};

}  // namespace weir::scene
