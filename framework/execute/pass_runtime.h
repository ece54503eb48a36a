// One pass of a compiled graph on the device: what its prepare() asked for, and what its record() launches.
#pragma once

#include <weir/execute/pipeline_library.h>
#include <weir/execute/prelude.h>
#include <weir/execute/resources.h>
#include <weir/execute/scene_frame.h>
#include <weir/pass/pass.h>
#include <weir/pass/registry.h>
#include <weir/scene/upload.h>
#include <weir/shader/compiler.h>

#include <array>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace weir::execute {

/// What runtimes of graphs need and do not own.
struct Services {
  const gpu::Device* device = nullptr;
  shader::Compiler* compiler = nullptr;
  Registry* registry = nullptr;
  PipelineLibrary* pipelines = nullptr;
  /// Every file that a shader was read from or looked for in, added to also when something fails. May be left out.
  std::set<std::string>* files = nullptr;
};

/// What all passes of a graph share. Owned by the graph's runtime, outlives theirs.
struct Shared {
  Services services;
  const SceneFrame* frame = nullptr;
  graph::CompiledGraph* graph = nullptr;  ///< passes add their scratch resources to it
  trace::Backend backend = trace::Backend::None;
  bool countRays = false;
  std::string sceneFolder;
  std::optional<HitShaders> hitShaders;  ///< compiled when first needed
};

/// Where in a frame the recording is.
struct FrameCursor {
  VkCommandBuffer commands = VK_NULL_HANDLE;
  VkDescriptorSet sceneSet = VK_NULL_HANDLE;
  uint32_t frameOffset = 0;  ///< dynamic offset of the first lane's frame constants
  uint32_t slot = 0, parity = 0;
  uint32_t lanes = 1;  ///< that the frame has: each launch is one of each of them
};

class PassRuntime {
 public:
  /// Creates the pass. RuntimeError when its plugin was loaded anew since the graph was compiled.
  PassRuntime(Shared& shared, uint32_t index);
  ~PassRuntime();
  PassRuntime(const PassRuntime&) = delete;
  PassRuntime& operator=(const PassRuntime&) = delete;

  /// Runs the pass's prepare(), which adds scratch resources to the graph. Throws what that throws, with the pass's
  /// name in front.
  void prepare();
  /// Binds the graph's resources, of each lane, to the kernels. With `bySlot` (one lane) each frame in flight has
  /// bindings of its own, as the host's resources may change from one to the next; what is not there yet is left
  /// unbound.
  void bind(std::span<const std::unique_ptr<Resources>> lanes, bool bySlot);
  /// The same for one slot, which no frame in flight uses, after one of the graph's resources was exchanged.
  void rebind(uint32_t slot, uint32_t resource);
  void record(const FrameCursor& cursor);

  graph::Stages stages() const { return stages_; }  ///< of all its kernels
  /// Whether the parameters of `pass` can be used without preparing anew, and then using them.
  bool accepts(const graph::CompiledPass& pass) const;
  void take(const graph::CompiledPass& pass);

 private:
  friend class Preparing;
  friend class Recording;
  template <typename Base>
  friend class Answers;
  /// A binding of set 1 and the resource that stands there.
  struct Slot {
    uint32_t binding = 0, resource = graph::kNone;
    bool previous = false;
  };
  struct PreparedKernel {
    std::shared_ptr<Pipeline> pipeline;
    std::vector<Slot> slots;
    std::vector<VkDescriptorSet> sets;                     ///< by lane and parity, or by slot and parity
    uint32_t target = graph::kNone, depth = graph::kNone;  ///< resources, of raster kernels
  };
  struct OwnTexture {
    gpu::Image image;
    VkSampler sampler = VK_NULL_HANDLE;
  };

  graph::CompiledPass& compiled() const { return shared_.graph->passes[index_]; }
  const gpu::Device& device() const { return *shared_.services.device; }
  void makeLayouts();
  void fillPush();
  uint32_t addScratch(graph::Resource resource);
  Kernel addKernel(KernelKind kind, const std::string& file, const KernelOptions& options);
  void checkFile(const std::string& file, const shader::CompileRequest& request) const;
  std::vector<uint32_t> compile(const shader::CompileRequest& request);
  std::vector<uint32_t> compile(KernelKind kind, shader::Stage stage, const std::string& file,
                                const KernelOptions& options);
  std::string pipelineKey(KernelKind kind, const std::vector<const std::vector<uint32_t>*>& spirv) const;
  std::vector<Slot> slotsFor(const KernelOptions& options) const;
  Slot slotNamed(const std::string& name) const;
  void makeSets(PreparedKernel& kernel, uint32_t count);
  void writeSets(const PreparedKernel& kernel, uint32_t laneOrSlot) const;
  void writeSet(const PreparedKernel& kernel, VkDescriptorSet set, const Resources& resources, uint32_t slot,
                uint32_t parity) const;
  const HitShaders& hitShaders();

  Shared& shared_;
  uint32_t index_;
  PassPtr pass_;
  KernelInterface interface_;
  std::vector<OwnTexture> textures_;
  VkDescriptorSetLayout setLayout_ = VK_NULL_HANDLE;
  VkPipelineLayout pipelineLayout_ = VK_NULL_HANDLE;
  std::vector<VkDescriptorPool> pools_;
  std::vector<PreparedKernel> kernels_;
  std::vector<uint32_t> push_;  ///< the launch's four words, then parameters
  Specialization constants_;
  graph::Stages stages_ = 0;
  bool bySlot_ = false;
  std::vector<const Resources*> lanes_;  ///< once bound
  std::set<std::string> asked_;          ///< parameters that prepare() looked at
};

}  // namespace weir::execute
