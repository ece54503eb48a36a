// Resources with their sizes and lifetimes, and what each pass binds.
#include <weir/core/error.h>
#include <weir/core/text.h>
#include <weir/graph/checked.h>

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace weir::graph {
namespace {

/// Shaders index elements with 32 bits.
constexpr uint64_t kMostElements = std::numeric_limits<uint32_t>::max();

uint32_t scaled(uint32_t size, const PortType& type) {
  const uint64_t up = uint64_t{size} * type.scaleNumerator + type.scaleDenominator - 1;
  return static_cast<uint32_t>(std::min<uint64_t>(up / type.scaleDenominator, kMostElements));
}

class Planner {
 public:
  Planner(const Checked& checked, const Order& order, const CompileOptions& options, CompiledGraph& graph,
          Findings& findings)
      : checked_(checked), order_(order), options_(options), graph_(graph), findings_(findings) {}

  void plan() {
    resourceOf_.resize(checked_.nodes.size());
    for (uint32_t p = 0; p < order_.nodes.size(); ++p) addPass(p);
    for (const Source& source : checked_.provided) addProvided(source);
    // After all resources are there: history is read by passes that come before its producer.
    for (uint32_t p = 0; p < order_.nodes.size(); ++p) bindInputs(p);
    for (const OutputLink& link : checked_.outputs) {
      GraphOutput output{link.entry->name, resource(link.resolved), isPrevious(link.resolved)};
      Resource& r = graph_.resources[output.resource];
      r.graphOutput = true;
      r.history |= output.previous;
      graph_.outputs.push_back(std::move(output));
    }
    std::sort(graph_.outputs.begin(), graph_.outputs.end(),
              [](const GraphOutput& a, const GraphOutput& b) { return a.name < b.name; });
    graph_.skipped = order_.skipped;
    for (const std::string& name : options_.external) {
      Resource* r = find(name);
      if (r == nullptr) throw InputError(fmt::format("external: nobody writes '{}': its pass does not run", name));
      r->external = true;
    }
    for (const std::string& name : options_.keep)
      if (Resource* r = find(name)) r->kept = true;
    if (!findings_.any()) endLives();
  }

 private:
  void addPass(uint32_t index) {
    const Node& node = checked_.nodes[order_.nodes[index]];
    CompiledPass pass;
    pass.name = node.name();
    pass.type = node.entry->type;
    pass.description = node.type;
    pass.params = node.params;
    pass.stages = node.type->has(Need::SceneAcceleration) ? kRayStage : kComputeStage;
    if (node.type->draws) pass.stages |= kRasterStage;
    const uint64_t hash = fnv1a(node.name());
    pass.stream = static_cast<uint32_t>(hash ^ (hash >> 32));
    for (uint32_t o = 0; o < node.type->outputs.size(); ++o) {
      const uint32_t resource = static_cast<uint32_t>(graph_.resources.size());
      resourceOf_[order_.nodes[index]].push_back(resource);
      pass.outputs.push_back({node.type->outputs[o].name, resource, false});
      graph_.resources.push_back(makeResource(node, o, index));
    }
    graph_.passes.push_back(std::move(pass));
  }

  void addProvided(const Source& source) {
    Resource r = makeResource(checked_.nodes[source.node], source.output, kNone);
    if (source.previous) r.name += "@previous";
    r.external = true;
    r.firstUse = 0;
    provided_.push_back(static_cast<uint32_t>(graph_.resources.size()));
    graph_.resources.push_back(std::move(r));
  }

  /// The resource that a pass makes for this port; nullptr when the pass does not run.
  Resource* find(const std::string& name) {
    const auto found = std::find_if(graph_.resources.begin(), graph_.resources.end(),
                                    [&](const Resource& r) { return r.name == name && r.producer != kNone; });
    return found == graph_.resources.end() ? nullptr : &*found;
  }

  void endLives() {
    if (graph_.passes.empty()) return;
    const auto last = static_cast<uint32_t>(graph_.passes.size() - 1);
    for (Resource& r : graph_.resources) {
      r.kept |= options_.keepAll;
      if (r.external && r.history)
        throw InputError(fmt::format("external: '{}' has to be the graph's own, as its @previous is read", r.name));
      if (r.kept || r.graphOutput) r.lastUse = last;
    }
  }

  Resource makeResource(const Node& node, uint32_t o, uint32_t producer) {
    const PortDescription& port = node.type->outputs[o];
    Resource r;
    r.name = node.name() + "." + port.name;
    r.type = port.type;
    r.producer = producer;
    r.firstUse = r.lastUse = producer == kNone ? 0 : producer;
    if (port.type.fixedCount != 0) {
      r.elements = port.type.fixedCount;
    } else {
      r.width = scaled(graph_.width, port.type);
      r.height = scaled(graph_.height, port.type);
      r.perPixel = node.perPixel[o];
      r.elements = uint64_t{r.width} * r.height;
    }
    // Before multiplying on, so that nothing overflows.
    if (r.elements > kMostElements / r.perPixel) {
      findings_.add(
          node.entry->line, "passes." + node.name(),
          fmt::format("output '{}' would have {} × {} pixels with {} elements each; expected at most {} in all",
                      port.name, r.width, r.height, r.perPixel, kMostElements));
      return r;
    }
    r.elements *= r.perPixel;
    const bool isImage = port.type.kind == PortKind::Image;
    r.bytes = r.elements * (isImage ? formatBytes(port.type.format) : port.type.layout.stride);
    if (isImage) r.elements = 0;
    return r;
  }

  void bindInputs(uint32_t index) {
    const Node& node = checked_.nodes[order_.nodes[index]];
    for (uint32_t i = 0; i < node.type->inputs.size(); ++i) {
      Binding binding;
      binding.port = node.type->inputs[i].name;
      // A link to an extra of a disabled pass leads nowhere.
      if (const Link* link = node.linkOf(i); link && link->resolved.node != kNone) {
        binding.resource = resource(link->resolved);
        binding.previous = isPrevious(link->resolved);
        Resource& r = graph_.resources[binding.resource];
        if (binding.previous)
          r.history = true;
        else
          r.lastUse = std::max(r.lastUse, index);
      }
      graph_.passes[index].inputs.push_back(std::move(binding));
    }
  }

  uint32_t resource(const Source& source) const {
    return source.provided != kNone ? provided_[source.provided] : resourceOf_[source.node][source.output];
  }
  /// What the host provides has no past that the graph keeps.
  static bool isPrevious(const Source& source) { return source.previous && source.provided == kNone; }

  const Checked& checked_;
  const Order& order_;
  const CompileOptions& options_;
  CompiledGraph& graph_;
  Findings& findings_;
  std::vector<std::vector<uint32_t>> resourceOf_;  ///< by node and output
  std::vector<uint32_t> provided_;                 ///< resources, as in Checked::provided
};

}  // namespace

void plan(const Checked& checked, const Order& order, const CompileOptions& options, CompiledGraph& graph,
          Findings& findings) {
  Planner(checked, order, options, graph, findings).plan();
}

}  // namespace weir::graph
