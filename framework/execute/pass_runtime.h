// One pass of a compiled graph on the device: what its prepare() asked for, and what its record() launches.
#pragma once

#include <weir/execute/pipelines.h>
#include <weir/execute/prelude.h>
#include <weir/execute/resources.h>
#include <weir/pass/pass.h>
#include <weir/pass/registry.h>
#include <weir/scene/upload.h>
#include <weir/shader/compiler.h>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace weir::execute {

/// What all passes of an executor share. Owned by the executor, outlives the runtimes.
struct Shared {
  const gpu::Device* device = nullptr;
  shader::Compiler* compiler = nullptr;
  Registry* registry = nullptr;
  const scene::SceneGpu* scene = nullptr;
  const std::vector<scene::SceneGpu::Draw>* draws = nullptr;  ///< of each instance in this frame
  const graph::CompiledGraph* graph = nullptr;
  const Resources* resources = nullptr;
  trace::Backend backend = trace::Backend::None;
  bool countRays = false;
  std::string sceneFolder;
  std::optional<HitShaders> hitShaders;  ///< compiled when first needed
};

/// Where in a frame the recording is.
struct FrameCursor {
  VkCommandBuffer commands = VK_NULL_HANDLE;
  VkDescriptorSet sceneSet = VK_NULL_HANDLE;
  uint32_t frameOffset = 0;  ///< dynamic offset of the frame constants
  uint32_t parity = 0;
};

class PassRuntime {
 public:
  /// Creates the pass and runs its prepare(). Throws what that throws, with the pass's name in front.
  PassRuntime(Shared& shared, const graph::CompiledPass& pass);
  ~PassRuntime();
  PassRuntime(const PassRuntime&) = delete;
  PassRuntime& operator=(const PassRuntime&) = delete;

  void record(const FrameCursor& cursor);

  VkPipelineStageFlags2 stages() const { return stages_; }  ///< of all its kernels
  bool hasScratch() const { return !scratch_.empty(); }
  uint64_t scratchBytes() const;

 private:
  friend class Preparing;
  friend class Recording;
  struct PreparedKernel {
    Pipeline* pipeline = nullptr;
    std::array<VkDescriptorSet, 2> sets{};  ///< by parity
    uint32_t rasterTarget = graph::kNone;   ///< index into scratch_
  };
  struct OwnTexture {
    gpu::Image image;
    VkSampler sampler = VK_NULL_HANDLE;
  };

  void makeLayouts();
  Kernel addKernel(KernelKind kind, const std::string& file, const KernelOptions& options);
  shader::CompileRequest request(shader::Stage stage, const std::string& source, const KernelOptions& options) const;
  std::array<VkDescriptorSet, 2> makeSets(const KernelOptions& options);
  const Storage& storageNamed(const std::string& name, uint32_t parity) const;
  const HitShaders& hitShaders();

  Shared& shared_;
  const graph::CompiledPass& compiled_;
  PassPtr pass_;
  KernelInterface interface_;
  std::vector<Storage> scratch_;
  gpu::Image depth_;  ///< of raster kernels
  std::vector<OwnTexture> textures_;
  VkDescriptorSetLayout setLayout_ = VK_NULL_HANDLE;
  VkPipelineLayout pipelineLayout_ = VK_NULL_HANDLE;
  std::vector<VkDescriptorPool> pools_;
  std::vector<std::pair<std::string, std::unique_ptr<Pipeline>>>
      pipelines_;  ///< by kind and source: kernels that differ in bindings share one
  std::vector<PreparedKernel> kernels_;
  std::vector<uint32_t> push_;  ///< the launch's four words, then parameters
  Specialization constants_;
  VkPipelineStageFlags2 stages_ = 0;
};

}  // namespace weir::execute
