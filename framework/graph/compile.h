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

/// Where on the device a pass works: a mask. execute/ maps it to Vulkan's pipeline stages.
using Stages = uint8_t;
inline constexpr Stages kComputeStage = 1, kRayStage = 2, kRasterStage = 4;

/// A buffer or image that the graph uses. History resources have two copies, written in turn. All others live from the
/// pass that writes them to their last reader, and share memory with those that live at other times.
struct Resource {
  std::string name;  ///< "temporal.reservoirs"; "temporal scratch half" for a pass's own
  PortType type;
  uint32_t width = 0, height = 0;  ///< images, and per-pixel buffers: the extent they cover
  uint32_t perPixel = 1;           ///< elements a pixel
  uint64_t elements = 0;           ///< buffers
  uint64_t bytes = 0;              ///< of the data of one copy
  bool history = false;            ///< read by somebody as @previous
  bool graphOutput = false;        ///< named under "outputs": alive to the frame's end
  bool kept = false;               ///< somebody wants to look at it after the frame: alive to the frame's end
  bool external = false;           ///< memory and synchronization are the host's; a producer may write it
  bool depth = false;              ///< a scratch image for depth tests, 32 bits, which no shader sees
  bool scratch = false;            ///< of its producer alone, which reads and writes it
  uint32_t producer = kNone;       ///< index into CompiledGraph::passes; kNone: the host provides the content
  uint32_t firstUse = kNone, lastUse = kNone;  ///< pass indices within a frame, readers of this frame's value
  uint64_t memoryBytes = 0;                    ///< what one copy takes: more than its data where a device wants that
  uint32_t block = kNone;                      ///< which shared block it lies in; kNone: memory of its own
  uint64_t offset = 0;                         ///< bytes, within the block
  bool shares = false;                         ///< somebody else uses some of its memory at another time
  bool transient() const { return !history && !external; }
  bool isImage() const { return type.kind == PortKind::Image; }
};

/// Whether two resources have bytes in common.
bool shareMemory(const Resource& a, const Resource& b);

struct Binding {
  std::string port;
  uint32_t resource = kNone;  ///< kNone: an optional input left open
  bool previous = false;      ///< reads last frame's copy
};

enum class Hazard : uint8_t { ReadAfterWrite, WriteAfterRead, WriteAfterWrite };

/// Something that must be over, and for a write visible, before a pass runs.
struct Dependency {
  Hazard hazard = Hazard::ReadAfterWrite;
  uint32_t resource = kNone;  ///< what the pass is about to use
  uint32_t memoryOf = kNone;  ///< whose use must be over: the same resource, or one that had its memory before
  uint32_t pass = kNone;      ///< who used it
  uint32_t framesBack = 0;    ///< in which frame: 0 this one, 1 the last, 2 the one before
  bool covered = false;       ///< by a barrier that stands before an earlier pass, or by the image's own
};

/// A memory barrier: writes of all earlier work in stages `from` are visible to later work in stages `to`. Without
/// `writes` it only orders.
struct Wait {
  Stages from = 0, to = 0;
  bool writes = false;                     ///< of `from`, made available
  bool toReads = false, toWrites = false;  ///< visible to these
  bool operator==(const Wait&) const = default;
};

/// An image that takes over memory which others used: its content starts undefined, and it is put into its layout. What
/// they wrote is made available by the waits, here or earlier.
struct ImageStart {
  uint32_t resource = kNone;
  Stages from = 0;  ///< of who had the memory: it comes after them
  bool operator==(const ImageStart&) const = default;
};

struct CompiledPass {
  std::string name, type;
  const PassDescription* description = nullptr;           ///< owned by the registry
  std::map<std::string, ParamValue, std::less<>> params;  ///< complete: defaults filled in, types as described
  std::vector<Binding> inputs, outputs;                   ///< in the description's order; outputs are never kNone
  std::vector<uint32_t> scratch;                          ///< resources of its own: known once the pass is prepared
  Stages stages = 0;                     ///< what it runs in; until it is prepared, what its description suggests
  std::vector<Dependency> dependencies;  ///< everything that it has to wait for
  std::vector<Wait> waits;               ///< the barriers that stand before it, one command together with
  std::vector<ImageStart> starts;        ///< these
  uint32_t stream = 0;                   ///< key of this pass's random numbers: FNV-1a of its name, folded to 32 bits
};

/// Memory that transient resources share.
struct MemoryBlock {
  uint64_t bytes = 0, alignment = 1;
  uint32_t kinds = 0xffffffffu;  ///< memory types that all of its resources can live in
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
  std::vector<MemoryBlock> blocks;
  uint64_t transientBytes() const;  ///< of resources that live within a frame, shared blocks and others
  uint64_t sharedBytes() const;     ///< of all blocks
  uint64_t separateBytes() const;   ///< what the transient resources would take each on its own
  uint64_t mostAlive() const;       ///< of those at once: no plan can take less
  uint64_t historyBytes() const;    ///< both copies
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

struct CompileOptions {
  uint32_t width = 0, height = 0;  ///< of the frame
  // Names of ports; InputError when the graph has no such port.
  /// "pass.port" or "pass.port@previous": its readers get a resource of the host's instead, and the pass that would
  /// make it does not run unless something else needs it.
  std::vector<std::string> provided;
  /// "pass.port": an output of a pass that is written into a resource of the host's. InputError when it does not run.
  std::vector<std::string> external;
  /// "pass.port": stays readable to the frame's end, if its pass runs.
  std::vector<std::string> keep;
  bool keepAll = false;
};

/// Checks everything and plans. Findings are appended; when there are any (also from earlier steps), the result must
/// not be used. Order: topological by edges without @previous, ties broken by pass name, so that equal graphs give
/// equal plans.
CompiledGraph compile(const Description& description, const PassCatalog& catalog, const CompileOptions& options,
                      std::vector<Diagnostic>& diagnostics);
CompiledGraph compile(const Description& description, const PassCatalog& catalog, uint32_t width, uint32_t height,
                      std::vector<Diagnostic>& diagnostics);

/// load/parse → apply → compile, throwing GraphError when anything was found.
CompiledGraph compileFile(const std::string& path, const Overrides& overrides, const PassCatalog& catalog,
                          const CompileOptions& options);
CompiledGraph compileFile(const std::string& path, const Overrides& overrides, const PassCatalog& catalog,
                          uint32_t width, uint32_t height);

/// The same from the JSON itself; `file` stands for it in messages.
CompiledGraph compileText(const std::string& json, const std::string& file, const Overrides& overrides,
                          const PassCatalog& catalog, const CompileOptions& options);

/// What a resource asks of the memory it lies in.
struct MemoryNeed {
  uint64_t bytes = 0, alignment = 1;  ///< alignment: a power of two
  uint32_t kinds = 0xffffffffu;       ///< memory types, a mask
};
/// Without a device: the bytes of the data, aligned to 256.
std::vector<MemoryNeed> logicalNeeds(const CompiledGraph& graph);
/// Places every transient resource: those whose lives overlap lie apart, in as few bytes as a greedy search by size
/// finds. `needs` by resource. `share` false: each has memory of its own. No block is larger than `largest` unless a
/// single resource is.
void planMemory(CompiledGraph& graph, const std::vector<MemoryNeed>& needs, bool share = true,
                uint64_t largest = 0xffffffffffffffffull);
/// What each pass waits for, from places and stages: for a frame that follows another of the same graph. The first
/// frame, and one after a clear, need no more.
void planBarriers(CompiledGraph& graph);

/// `weir graph explain` and `dot`.
std::string explain(const CompiledGraph& graph);
std::string dot(const CompiledGraph& graph);

}  // namespace weir::graph
