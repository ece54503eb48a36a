#include <weir/core/error.h>
#include <weir/trace/acceleration.h>

namespace weir::trace {

const char* backendName(Backend backend) {
  switch (backend) {
    case Backend::Pipeline:
      return "pipeline";
    case Backend::Query:
      return "query";
    default:
      return "none";
  }
}

Backend chooseBackend(const std::string& text, const gpu::Device& device) {
  const gpu::Capabilities& has = device.capabilities();
  const bool pipeline = has.accelerationStructure && has.rayPipeline;
  const bool query = has.accelerationStructure && has.rayQuery;
  if (text.empty() || text == "auto") return pipeline ? Backend::Pipeline : query ? Backend::Query : Backend::None;
  if (text == "pipeline") {
    if (!pipeline) throw InputError("--trace pipeline: " + device.info().name + " has no ray-tracing pipelines");
    return Backend::Pipeline;
  }
  if (text == "query") {
    if (!query) throw InputError("--trace query: " + device.info().name + " has no ray queries");
    return Backend::Query;
  }
  throw InputError("--trace: '" + text + "' is none of auto, pipeline, query");
}

Acceleration::Acceleration(const gpu::Device& device, const scene::PreparedScene& scene, const gpu::Buffer& positions) {
  for (size_t r = 0; r < scene.ranges.size(); ++r) {
    if (scene.ranges[r].deformation >= 0) {
      bottom_.emplace_back();
      continue;
    }
    const RangeGeometry range(device, scene, r, positions.address());
    VkAccelerationStructureBuildGeometryInfoKHR info = range.info();
    bottom_.push_back(buildNow(device, info, range.counts, "bottom-level structure " + std::to_string(r)));
  }
  if (scene.traits.animated) return;
  std::vector<VkAccelerationStructureInstanceKHR> instances;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const scene::PreparedInstance& source = scene.instances[i];
    instances.push_back(instanceOf(scene, i, source.toWorld, bottom_[source.range].address()));
  }
  const gpu::Buffer buffer = gpu::uploadBuffer(device, instances, kBuildInput, "top-level instances");
  const InstanceGeometry geometry(buffer.address());
  VkAccelerationStructureBuildGeometryInfoKHR info = geometry.info();
  top_ = buildNow(device, info, {static_cast<uint32_t>(instances.size())}, "top-level structure");
}

uint64_t Acceleration::bytes() const {
  uint64_t sum = top_.bytes();
  for (const Structure& s : bottom_) sum += s.bytes();
  return sum;
}

}  // namespace weir::trace
