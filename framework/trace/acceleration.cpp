#include <weir/core/error.h>
#include <weir/trace/acceleration.h>

#include <algorithm>
#include <cstring>
#include <utility>

namespace weir::trace {
namespace {

constexpr VkBufferUsageFlags kBuildInput =
    VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;

VkTransformMatrixKHR transformOf(const glm::mat4& m) {
  VkTransformMatrixKHR t{};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) t.matrix[row][column] = m[column][row];
  }
  return t;
}

}  // namespace

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

Acceleration::Acceleration(const gpu::Device& device, const scene::PreparedScene& scene, const gpu::Buffer& positions)
    : device_(&device) {
  buildBottom(scene, positions);
  buildTop(scene);
}

Acceleration::~Acceleration() {
  destroy();
}

Acceleration::Acceleration(Acceleration&& other) noexcept
    : device_(std::exchange(other.device_, nullptr)),
      bottom_(std::move(other.bottom_)),
      top_(std::exchange(other.top_, Structure{})) {}

Acceleration& Acceleration::operator=(Acceleration&& other) noexcept {
  if (this != &other) {
    destroy();
    device_ = std::exchange(other.device_, nullptr);
    bottom_ = std::move(other.bottom_);
    other.bottom_.clear();
    top_ = std::exchange(other.top_, Structure{});
  }
  return *this;
}

void Acceleration::destroy() {
  if (device_ == nullptr) return;
  for (Structure& s : bottom_) vkDestroyAccelerationStructureKHR(device_->handle(), s.handle, nullptr);
  vkDestroyAccelerationStructureKHR(device_->handle(), top_.handle, nullptr);
  bottom_.clear();
  device_ = nullptr;
}

uint64_t Acceleration::bytes() const {
  uint64_t sum = top_.buffer.size();
  for (const Structure& s : bottom_) sum += s.buffer.size();
  return sum;
}

Acceleration::Structure Acceleration::build(const VkAccelerationStructureGeometryKHR* geometries,
                                            const std::vector<uint32_t>& counts, bool top, const std::string& name) {
  VkAccelerationStructureBuildGeometryInfoKHR info{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR};
  info.type = top ? VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR : VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR;
  info.flags = VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_TRACE_BIT_KHR;
  info.mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR;
  info.geometryCount = static_cast<uint32_t>(counts.size());
  info.pGeometries = geometries;
  VkAccelerationStructureBuildSizesInfoKHR sizes{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR};
  vkGetAccelerationStructureBuildSizesKHR(device_->handle(), VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR, &info,
                                          counts.data(), &sizes);

  Structure s;
  s.buffer =
      gpu::Buffer(*device_, sizes.accelerationStructureSize,
                  VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                  gpu::Residency::Device, name);
  VkAccelerationStructureCreateInfoKHR create{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_CREATE_INFO_KHR};
  create.buffer = s.buffer.handle();
  create.size = sizes.accelerationStructureSize;
  create.type = info.type;
  gpu::check(vkCreateAccelerationStructureKHR(device_->handle(), &create, nullptr, &s.handle),
             "vkCreateAccelerationStructureKHR");
  device_->name(VK_OBJECT_TYPE_ACCELERATION_STRUCTURE_KHR, reinterpret_cast<uint64_t>(s.handle), name);

  const gpu::Buffer scratch(*device_, sizes.buildScratchSize,
                            VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                            gpu::Residency::Device, name + " scratch", device_->capabilities().minScratchAlignment);
  info.dstAccelerationStructure = s.handle;
  info.scratchData.deviceAddress = scratch.address();
  std::vector<VkAccelerationStructureBuildRangeInfoKHR> ranges(counts.size());
  for (size_t i = 0; i < counts.size(); ++i) ranges[i].primitiveCount = counts[i];
  const VkAccelerationStructureBuildRangeInfoKHR* rangePointer = ranges.data();
  device_->submitAndWait([&](VkCommandBuffer commands) {
    gpu::fullBarrier(commands);
    vkCmdBuildAccelerationStructuresKHR(commands, 1, &info, &rangePointer);
    gpu::fullBarrier(commands);
  });

  VkAccelerationStructureDeviceAddressInfoKHR address{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR};
  address.accelerationStructure = s.handle;
  s.address = vkGetAccelerationStructureDeviceAddressKHR(device_->handle(), &address);
  return s;
}

void Acceleration::buildBottom(const scene::PreparedScene& scene, const gpu::Buffer& positions) {
  for (size_t r = 0; r < scene.ranges.size(); ++r) {
    const scene::TriangleRange& range = scene.ranges[r];
    // Vulkan wants indices tightly packed; shaders read them beside the material. This copy lives for the build only.
    std::vector<uint32_t> indices;
    indices.reserve(3 * (size_t{range.opaque} + range.masked));
    for (uint32_t t = range.first; t < range.first + range.opaque + range.masked; ++t) {
      indices.insert(indices.end(), std::begin(scene.triangles[t].v), std::end(scene.triangles[t].v));
    }
    const gpu::Buffer indexBuffer = gpu::uploadBuffer(*device_, indices, kBuildInput, "acceleration structure indices");

    std::vector<VkAccelerationStructureGeometryKHR> geometries;
    std::vector<uint32_t> counts;
    auto add = [&](uint32_t first, uint32_t count, bool opaque) {
      VkAccelerationStructureGeometryKHR g{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR};
      g.geometryType = VK_GEOMETRY_TYPE_TRIANGLES_KHR;
      // Transmittance multiplies once a surface: a second any-hit call for the same triangle would count it twice.
      g.flags = opaque ? VK_GEOMETRY_OPAQUE_BIT_KHR : VK_GEOMETRY_NO_DUPLICATE_ANY_HIT_INVOCATION_BIT_KHR;
      auto& t = g.geometry.triangles;
      t.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_TRIANGLES_DATA_KHR;
      t.vertexFormat = VK_FORMAT_R32G32B32_SFLOAT;
      t.vertexData.deviceAddress = positions.address();
      t.vertexStride = sizeof(glm::vec3);
      t.maxVertex = scene.positions.empty() ? 0 : static_cast<uint32_t>(scene.positions.size() - 1);
      t.indexType = VK_INDEX_TYPE_UINT32;
      t.indexData.deviceAddress = indexBuffer.address() + uint64_t{first} * 3 * sizeof(uint32_t);
      geometries.push_back(g);
      counts.push_back(count);
    };
    // Geometry 1 must be the one with alpha even when there are no opaque triangles: shaders count on it.
    add(0, range.opaque, true);
    if (range.masked > 0) add(range.opaque, range.masked, false);
    bottom_.push_back(build(geometries.data(), counts, false, "bottom-level structure " + std::to_string(r)));
  }
}

void Acceleration::buildTop(const scene::PreparedScene& scene) {
  std::vector<VkAccelerationStructureInstanceKHR> instances;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const scene::PreparedInstance& source = scene.instances[i];
    VkAccelerationStructureInstanceKHR instance{};
    instance.transform = transformOf(source.toWorld);
    instance.instanceCustomIndex = static_cast<uint32_t>(i);
    instance.mask = 0xff;
    // Facing is decided in object space, where glTF's fronts are counter-clockwise, as are Vulkan's: a mirroring
    // transform turns the ray's side along with the winding.
    if (scene.ranges[source.range].doubleSided)
      instance.flags = VK_GEOMETRY_INSTANCE_TRIANGLE_FACING_CULL_DISABLE_BIT_KHR;
    instance.accelerationStructureReference = bottom_[source.range].address;
    instances.push_back(instance);
  }
  const gpu::Buffer buffer = gpu::uploadBuffer(*device_, instances, kBuildInput, "top-level instances");
  VkAccelerationStructureGeometryKHR g{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR};
  g.geometryType = VK_GEOMETRY_TYPE_INSTANCES_KHR;
  g.geometry.instances.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_INSTANCES_DATA_KHR;
  g.geometry.instances.data.deviceAddress = buffer.address();
  top_ = build(&g, {static_cast<uint32_t>(instances.size())}, true, "top-level structure");
}

}  // namespace weir::trace
