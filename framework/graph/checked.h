// The compiler's working data, between Description and CompiledGraph, and its steps in their order. Private to this
// folder.
#pragma once

#include <weir/graph/compile.h>

#include <map>
#include <set>
#include <string>
#include <vector>

namespace weir::graph {

/// An output of a pass, this frame's or last frame's.
struct Source {
  uint32_t node = kNone;
  uint32_t output = kNone;  ///< kNone with a node: the pass is known, its port is not
  bool previous = false;
  uint32_t provided = kNone;  ///< the host's: index into Checked::provided
  bool known() const { return node != kNone && output != kNone; }
};

/// One entry under "inputs".
struct Link {
  const InputEntry* entry = nullptr;
  uint32_t input = kNone;  ///< index into the type's inputs; kNone: unknown
  Source written;          ///< as the file says
  Source resolved;         ///< the same with disabled passes taken out
};

struct OutputLink {
  const OutputEntry* entry = nullptr;
  Source written, resolved;
};

struct Node {
  const PassEntry* entry = nullptr;
  const PassDescription* type = nullptr;  ///< nullptr: unknown, and said so
  std::map<std::string, ParamValue, std::less<>> params;
  std::vector<Link> links;
  std::vector<uint32_t> perPixel;  ///< of each output; 0: could not be found out, and said why

  bool enabled() const { return entry->enabled; }
  const std::string& name() const { return entry->name; }
  const Link* linkOf(uint32_t input) const;
};

/// Collects diagnostics; `origin` replaces the file for what the command line said.
class Findings {
 public:
  Findings(const std::string& file, std::vector<Diagnostic>& diagnostics) : file_(file), diagnostics_(diagnostics) {}
  void add(int line, std::string path, std::string message, std::string nearest = "", const std::string& origin = "") {
    diagnostics_.push_back(
        {origin.empty() ? file_ : origin, line, std::move(path), std::move(message), std::move(nearest)});
  }
  bool any() const { return !diagnostics_.empty(); }

 private:
  const std::string& file_;
  std::vector<Diagnostic>& diagnostics_;
};

struct Checked {
  std::vector<Node> nodes;  ///< by name
  std::vector<OutputLink> outputs;
  std::vector<Source> provided;  ///< ports whose content the host brings

  const PortDescription& port(const Source& source) const { return nodes[source.node].type->outputs[source.output]; }
  /// "pass.port" or "pass.port@previous".
  std::string text(const Source& source) const;
};

/// Types, parameters, and which pass and port each reference means.
Checked bind(const Description& description, const PassCatalog& catalog, Findings& findings);
/// One pass's parameters: defaults filled in, entries converted and checked.
void bindParams(Node& node, Findings& findings);
/// Takes disabled passes out: fills in every `resolved`.
void resolve(Checked& checked, Findings& findings);
/// Layouts, scales and element counts of what is connected; fills in every `perPixel`.
void matchPorts(Checked& checked, Findings& findings);
void findCycles(const Checked& checked, Findings& findings);

/// Which nodes run, and in which order. Only for a graph without findings.
struct Order {
  std::vector<uint32_t> nodes;
  std::vector<Skipped> skipped;
};
Order orderPasses(const Checked& checked);
/// Passes, resources, bindings, outputs.
void plan(const Checked& checked, const Order& order, const CompileOptions& options, CompiledGraph& graph,
          Findings& findings);

/// The first half of planBarriers: fills in every pass's dependencies.
void listDependencies(CompiledGraph& graph);

}  // namespace weir::graph
