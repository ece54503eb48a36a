// Mean of frames on the device, and how well it is known.
#pragma once

#include <weir/execute/executor.h>
#include <weir/execute/tool_kernel.h>
#include <weir/gpu/memory.h>

#include <cstdint>
#include <memory>

namespace weir::view {

class Accumulator {
 public:
  /// Frames of that size in pixels; 64 bytes a pixel. `sets`: frames that may be alive on the device at once. Throws
  /// InputError when the shader can't be read or a buffer would be larger than the device's shaders can see,
  /// RuntimeError when memory does not suffice.
  Accumulator(const gpu::Device& device, shader::Compiler& compiler, uint32_t width, uint32_t height, uint32_t sets);

  /// Adds a frame, an image of this size: as the `count`th, where 1 forgets what was there. `set`: what was recorded
  /// with it before must be done. Waits for everything submitted earlier, and everything later waits for it.
  void record(VkCommandBuffer commands, uint32_t set, const execute::Storage& frame, uint32_t count) const;

  /// The mean, RGBA32F. Alpha: estimated relMSE of the pixel's mean, that is the mean over R, G, B of its variance over
  /// (mean² + 0.01); 0 after one frame. Undefined before the first.
  execute::Executor::Located mean() const { return {&mean_, &resource_}; }
  uint64_t bytes() const { return sums_.size() + mean_.image.bytes(); }

 private:
  uint32_t width_, height_;
  graph::Resource resource_;
  std::unique_ptr<execute::ToolKernel> kernel_;
  gpu::Buffer sums_;
  execute::Storage mean_;
};

}  // namespace weir::view
