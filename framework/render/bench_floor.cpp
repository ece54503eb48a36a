#include <fmt/format.h>
#include <weir/graph/diagnostic.h>
#include <weir/render/bench_floor.h>
#include <weir/render/bench_measure.h>
#include <weir/render/bench_options.h>
#include <weir/render/laboratory.h>

#include <algorithm>
#include <utility>

namespace weir::render {
namespace {

constexpr const char* kCamera = "floor_camera";
constexpr const char* kBuffers = "floor_buffers";

bool carries(const PortDescription& port, const char* layout) {
  return port.type.kind == PortKind::Buffer && port.type.layout.name == layout;
}

/// The first input or output of that layout; empty: there is none.
std::string portOf(const std::vector<PortDescription>& ports, const char* layout) {
  const auto found = std::ranges::find_if(ports, [&](const PortDescription& p) { return carries(p, layout); });
  return found == ports.end() ? std::string() : found->name;
}

graph::InputEntry inputFrom(const std::string& port, const std::string& source) {
  return {port, source, graph::parseReference(source), 0, 0};
}

void addPass(graph::Description& d, const std::string& name, const std::string& type, const std::string& output,
             std::vector<graph::InputEntry> inputs = {}, std::vector<graph::ParamEntry> params = {}) {
  graph::PassEntry entry;
  entry.name = name;
  entry.type = type;
  entry.inputs = std::move(inputs);
  entry.params = std::move(params);
  d.passes.push_back(std::move(entry));
  const std::string source = name + "." + output;
  d.outputs.push_back({name, source, graph::parseReference(source), 0});
}

/// Bytes a pixel of all that passes hand to each other; scratch is a pass's own business.
uint64_t bytesOfBuffers(const graph::CompiledGraph& graph) {
  uint64_t bytes = 0;
  for (const graph::Resource& r : graph.resources)
    if (!r.scratch && r.type.fixedCount == 0) bytes += r.bytes;
  return bytes;
}

struct Plan {
  graph::CompiledGraph graph;
  std::vector<std::string> shadows;  ///< passes that trace shadow rays
  bool camera = false;
};

/// The configuration's own graph, with passes beside it that trace its rays again and move as many bytes.
Plan planFor(const FloorInput& in) {
  std::vector<graph::Diagnostic> findings;
  graph::Description d = graph::load(in.file, findings);
  graph::apply(d, in.overrides, findings);
  Plan plan;
  for (const graph::CompiledPass& pass : in.graph.passes) {
    if (pass.type == "gbuffer.RayTraced") plan.camera = true;
    const std::string reservoirs = portOf(pass.description->outputs, "Reservoir");
    const std::string surface = portOf(pass.description->inputs, "PackedSurface");
    const graph::PassEntry* entry = d.find(pass.name);
    if (reservoirs.empty() || surface.empty() || !entry) continue;
    const auto source = std::ranges::find(entry->inputs, surface, &graph::InputEntry::port);
    if (source == entry->inputs.end()) continue;
    const std::string name = "floor_shadow_" + pass.name, from = source->text;
    addPass(d, name, "floor.ShadowRays", "transmittance",
            {inputFrom("surface", from), inputFrom("reservoirs", pass.name + "." + reservoirs)});
    plan.shadows.push_back(name);
  }
  if (plan.camera) addPass(d, kCamera, "floor.CameraRays", "triangle");
  const uint64_t pixels = uint64_t{in.graph.width} * in.graph.height;
  const auto words =
      static_cast<int64_t>(std::clamp<uint64_t>((bytesOfBuffers(in.graph) / 4 + pixels - 1) / pixels, 1, 1024));
  addPass(d, kBuffers, "floor.Buffers", "words", {}, {{"words", words, 0, 0, {}, {}}});
  plan.graph = graph::compile(d, in.laboratory.registry().catalog(), in.graph.width, in.graph.height, findings);
  if (!findings.empty()) throw graph::GraphError(findings);
  return plan;
}

}  // namespace

std::optional<Floor> measureFloor(const FloorInput& in) {
  const Plan plan = planFor(in);
  const uint64_t pixels = uint64_t{in.graph.width} * in.graph.height;
  // Of the configuration's passes and of the floor's own.
  const uint64_t traced = countRays(*in.laboratory.executor(plan.graph, 1, true), in.laboratory.stage(), in.settings);
  const auto executor = in.laboratory.executor(plan.graph);
  const CostMeasure cost = measureCost(*executor, in.laboratory.stage(), in.settings);
  const auto msOf = [&](const std::string& name) {
    const auto found = std::ranges::find(cost.passes, name, &PassMeasure::name);
    return found != cost.passes.end() && found->gpuMs ? found->gpuMs->median : 0.0;
  };
  Floor floor;
  const uint64_t cameraRays = plan.camera ? pixels : 0;
  if (plan.camera) floor.parts.push_back({"camera rays", msOf(kCamera)});
  double shadowMs = 0;
  for (const std::string& name : plan.shadows) shadowMs += msOf(name);
  const uint64_t shadowRays = traced > in.rays + cameraRays ? traced - in.rays - cameraRays : 0;
  if (in.rays > cameraRays && shadowRays > 0)
    floor.parts.push_back(
        {"shadow rays", shadowMs / static_cast<double>(shadowRays) * static_cast<double>(in.rays - cameraRays)});
  floor.parts.push_back({"buffers", msOf(kBuffers)});
  for (const FloorPart& part : floor.parts) floor.gpuMs += part.gpuMs;
  if (!(floor.gpuMs > 0)) return std::nullopt;  // a device without timestamps
  floor.multiple = in.frameGpuMs / floor.gpuMs;
  return floor;
}

}  // namespace weir::render
