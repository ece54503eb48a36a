// Description + pass descriptions → an ordered plan as plain data: passes, resources, bindings, barriers, history. No
// Vulkan here; execute/ carries the plan out, tests and `weir graph explain` read it.
#pragma once

#include <weir/graph/description.h>
#include <weir/pass/description.h>

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace weir::graph {

inline constexpr uint32_t kNone = 0xffffffffu;

/// What a pass does with a resource. Every access is from shaders; execute/ maps it to stages.
enum class Access : uint8_t { None, Read, Write };

/// A buffer or image that the graph owns. History resources have two copies, written in turn.
struct Resource {
  std::string name;  ///< "temporal.reservoirs"
  PortType type;
  uint32_t width = 0, height = 0;              ///< images, and per-pixel buffers: the extent they cover
  uint32_t perPixel = 1;                       ///< elements a pixel
  uint64_t elements = 0;                       ///< buffers
  uint64_t bytes = 0;                          ///< of one copy
  bool history = false;                        ///< read by somebody as @previous
  bool graphOutput = false;                    ///< named under "outputs": alive to the frame's end
  uint32_t producer = kNone;                   ///< index into CompiledGraph::passes
  uint32_t firstUse = kNone, lastUse = kNone;  ///< pass indices within a frame, readers of this frame's value
};

struct Binding {
  std::string port;
  uint32_t resource = kNone;  ///< kNone: an optional input left open
  bool previous = false;      ///< reads last frame's copy
};

/// Before this pass runs, `resource` must be made available from `before` to `after`. Passes only: who reads a graph
/// output from outside the graph puts a barrier before and after.
struct Barrier {
  uint32_t resource = kNone;
  bool previous = false;
  Access before = Access::None, after = Access::None;
  uint32_t fromPass = kNone;  ///< kNone: an earlier frame or the clear
};

struct CompiledPass {
  std::string name, type;
  const PassDescription* description = nullptr;  ///< owned by the registry
  std::map<std::string, ParamValue> params;      ///< complete: defaults filled in, types as described
  std::vector<Binding> inputs, outputs;          ///< in the description's order; outputs are never kNone
  std::vector<Barrier> barriers;
  uint32_t stream = 0;  ///< key of this pass's random numbers: FNV-1a of its name, folded to 32 bits
};

struct GraphOutput {
  std::string name;
  uint32_t resource = kNone;
  bool previous = false;
};

/// A pass that does not run, and why.
struct Skipped {
  std::string pass, reason;
};

struct CompiledGraph {
  std::string name, file;
  uint32_t width = 0, height = 0;
  std::vector<CompiledPass> passes;  ///< in execution order
  std::vector<Resource> resources;
  std::vector<GraphOutput> outputs;
  std::vector<Skipped> skipped;
  const GraphOutput* findOutput(const std::string& outputName) const;
};

/// What the compiler asks of a registry; tests give their own.
struct PassCatalog {
  /// The description of "plugin.Pass"; nullptr when unknown.
  std::function<const PassDescription*(const std::string& type)> find;
  /// Every known type, for the nearest name.
  std::function<std::vector<std::string>()> types;
  /// Why a type that find() does not know can't be had ("its plugin was refused because…"), or empty. May be left out.
  std::function<std::string(const std::string& type)> problem;
};

/// Checks everything and plans. Findings are appended; when there are any (also from earlier steps), the result must
/// not be used. Order: topological by edges without @previous, ties broken by pass name, so that equal graphs give
/// equal plans.
CompiledGraph compile(const Description& description, const PassCatalog& catalog, uint32_t width, uint32_t height,
                      std::vector<Diagnostic>& diagnostics);

/// load/parse → apply → compile, throwing GraphError when anything was found.
CompiledGraph compileFile(const std::string& path, const Overrides& overrides, const PassCatalog& catalog,
                          uint32_t width, uint32_t height);

/// `weir graph explain` and `dot`.
std::string explain(const CompiledGraph& graph);
std::string dot(const CompiledGraph& graph);

}  // namespace weir::graph
