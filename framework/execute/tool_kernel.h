// A compute kernel that belongs to no graph: what shows pictures in a window, sums them up, and the like. Its storage
// buffers and images are bound when it is recorded.
#pragma once

#include <weir/execute/pipelines.h>
#include <weir/shader/compiler.h>

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace weir::execute {

/// What stands at a binding: a storage buffer, or a storage image in VK_IMAGE_LAYOUT_GENERAL.
struct ToolBinding {
  VkBuffer buffer = VK_NULL_HANDLE;
  VkImageView image = VK_NULL_HANDLE;
};

struct ToolKernelOptions {
  std::string name;                         ///< in messages and captures
  std::string file;                         ///< GLSL, with its own layout() of set 0 and push constants
  std::vector<std::string> includeFolders;  ///< beside the file's own; shaders/common comes last
  std::vector<std::pair<std::string, std::string>> defines;
  std::vector<bool> images;  ///< by binding: an image, or else a buffer
  uint32_t pushBytes = 0;    ///< of push constants, at most 128
  /// Recordings that may be alive on the device at once: each has a descriptor set of its own.
  uint32_t sets = 2;
  uint32_t groupSide = 8;  ///< of the shader's workgroups: groupSide x groupSide
};

class ToolKernel {
 public:
  /// Throws InputError when the file can't be read, shader::CompileError when it doesn't compile.
  ToolKernel(const gpu::Device& device, shader::Compiler& compiler, const ToolKernelOptions& options);
  ~ToolKernel();
  ToolKernel(const ToolKernel&) = delete;
  ToolKernel& operator=(const ToolKernel&) = delete;

  /// Binds and launches width x height invocations, in whole groups. `set` < sets: what was recorded with it before
  /// must be done on the device. `bindings` by binding, `push` of pushBytes bytes. Barriers are the caller's.
  void record(VkCommandBuffer commands, uint32_t set, std::span<const ToolBinding> bindings,
              std::span<const std::byte> push, uint32_t width, uint32_t height) const;

  /// Every file that the shader was read from.
  const std::vector<std::string>& files() const { return files_; }

 private:
  void makeLayouts(const ToolKernelOptions& options);
  void destroy() noexcept;

  const gpu::Device& device_;
  std::vector<bool> images_;
  uint32_t pushBytes_;
  std::vector<std::string> files_;
  VkDescriptorSetLayout setLayout_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  std::vector<VkDescriptorSet> sets_;
  Pipeline pipeline_;
};

}  // namespace weir::execute
