// What stands behind the handles of embed.h. Not for others.
#pragma once

#include <weir/embed/embed.h>
#include <weir/execute/graph_runtime.h>
#include <weir/graph/compile.h>
#include <weir/pass/registry.h>
#include <weir/render/stage.h>
#include <weir/shader/compiler.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

struct Weir {
  Weir(const std::vector<std::filesystem::path>& folders, std::string cache)
      : registry(folders), compiler(cache), cacheFolder(std::move(cache)) {}
  weir::Registry registry;
  weir::shader::Compiler compiler;
  std::string cacheFolder;
  std::string message;
  std::vector<std::string> lines;
  std::vector<const char*> linePointers;  ///< of `lines`, for C
  uint32_t children = 0;                  ///< needs and contexts
};

struct WeirNeeds {
  WeirNeeds(Weir& root, const weir::gpu::HostDevice& host) : weir(root), needs(host) { ++weir.children; }
  ~WeirNeeds() { --weir.children; }
  WeirNeeds(const WeirNeeds&) = delete;
  WeirNeeds& operator=(const WeirNeeds&) = delete;
  Weir& weir;
  weir::gpu::HostNeeds needs;
};

struct WeirContext {
  WeirContext(Weir& root, const weir::gpu::HostDevice& host) : weir(root), device(host) { ++weir.children; }
  ~WeirContext() { --weir.children; }
  WeirContext(const WeirContext&) = delete;
  WeirContext& operator=(const WeirContext&) = delete;
  weir::execute::Services services() { return {&device, &weir.compiler, &weir.registry, &pipelines}; }
  Weir& weir;
  weir::gpu::Device device;
  weir::execute::PipelineLibrary pipelines;
  uint32_t children = 0;  ///< scenes
};

struct WeirScene {
  WeirScene(WeirContext& owner, const weir::render::StageOptions& options, float aspect)
      : context(owner),
        folder(std::filesystem::path(options.scene).parent_path().string()),
        stage(weir::render::makeStage(options, aspect)),
        player(stage),
        gpu(context.device, stage.scene, stage.prepared, context.device.capabilities().accelerationStructure) {
    ++context.children;
  }
  ~WeirScene() { --context.children; }
  WeirScene(const WeirScene&) = delete;
  WeirScene& operator=(const WeirScene&) = delete;
  WeirContext& context;
  std::string folder;
  weir::render::Stage stage;
  weir::render::Player player;
  weir::scene::SceneGpu gpu;
  uint32_t children = 0;  ///< graphs
};

namespace weir::embed {

/// A graph as the host asked for it: what it is compiled from, again after every change.
struct GraphSource {
  std::string json, file;
  graph::Overrides overrides;
  graph::CompileOptions options;
  std::string trace;
};

/// An image or a buffer of the host's in a place of the graph's.
struct Bound {
  std::string name;
  uint32_t slot = 0;
  bool written = false;  ///< by the graph
  bool isImage = false;
  WeirImage image{};
  WeirBuffer buffer{};
};

/// A runtime that frames in flight may still use.
struct Retired {
  std::unique_ptr<execute::GraphRuntime> runtime;
  uint32_t slots = 0;  ///< a mask: those whose frame is not known to be done
};

/// Queries of the host's that a frame was recorded with, and how many passes it had.
struct Timed {
  VkQueryPool queries = VK_NULL_HANDLE;
  uint32_t first = 0, passes = 0;
};

}  // namespace weir::embed

struct WeirGraph {
  WeirGraph(WeirScene& owner, weir::embed::GraphSource from, weir::trace::Backend backend);
  ~WeirGraph() { --scene.children; }
  WeirGraph(const WeirGraph&) = delete;
  WeirGraph& operator=(const WeirGraph&) = delete;
  Weir& weir() { return scene.context.weir; }

  /// Goes on with what `next` says; when that fails, with what was there.
  void change(weir::embed::GraphSource next);
  /// The host's resource of this name; InputError naming the nearest.
  const weir::graph::Resource& port(const std::string& name) const;
  void bind(weir::embed::Bound bound);
  void record(VkCommandBuffer commands, const weir::execute::FrameInput& input, uint32_t slot,
              const weir::execute::Stamps& stamps);

  WeirScene& scene;
  void timeWith(VkQueryPool queries, uint32_t first);
  uint32_t passesTimedWith(VkQueryPool queries, uint32_t first) const;

  weir::embed::GraphSource source;
  weir::execute::ExecutorOptions options;
  weir::execute::SceneFrame frame;
  std::unique_ptr<weir::execute::GraphRuntime> runtime;
  std::vector<weir::embed::Retired> retired;
  std::vector<weir::embed::Bound> bound;
  std::vector<weir::embed::Timed> timed;
  uint32_t recorded = 0;  ///< a mask: slots that the runtime has recorded frames for
  bool replaced = false;  ///< the next frame is the runtime's first behind another's

 private:
  void put(const weir::embed::Bound& b);
  void hostBarrier(VkCommandBuffer commands, uint32_t slot, bool before) const;
};
