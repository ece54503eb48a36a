#include <weir/trace/structure.h>

#include <iterator>
#include <utility>

namespace weir::trace {

Structure::Structure(const gpu::Device& device, VkAccelerationStructureTypeKHR type, uint64_t size,
                     const std::string& name)
    : device_(&device),
      buffer_(device, size,
              VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
              gpu::Residency::Device, name) {
  VkAccelerationStructureCreateInfoKHR create{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_CREATE_INFO_KHR};
  create.buffer = buffer_.handle();
  create.size = size;
  create.type = type;
  gpu::check(vkCreateAccelerationStructureKHR(device.handle(), &create, nullptr, &handle_),
             "vkCreateAccelerationStructureKHR");
  device.name(VK_OBJECT_TYPE_ACCELERATION_STRUCTURE_KHR, reinterpret_cast<uint64_t>(handle_), name);
  VkAccelerationStructureDeviceAddressInfoKHR info{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR};
  info.accelerationStructure = handle_;
  address_ = vkGetAccelerationStructureDeviceAddressKHR(device.handle(), &info);
}

Structure::~Structure() {
  if (device_ != nullptr) vkDestroyAccelerationStructureKHR(device_->handle(), handle_, nullptr);
}

Structure::Structure(Structure&& other) noexcept
    : device_(std::exchange(other.device_, nullptr)),
      buffer_(std::move(other.buffer_)),
      handle_(std::exchange(other.handle_, VK_NULL_HANDLE)),
      address_(std::exchange(other.address_, 0)) {}

Structure& Structure::operator=(Structure&& other) noexcept {
  std::swap(device_, other.device_);
  std::swap(buffer_, other.buffer_);
  std::swap(handle_, other.handle_);
  std::swap(address_, other.address_);
  return *this;
}

RangeGeometry::RangeGeometry(const gpu::Device& device, const scene::PreparedScene& scene, size_t number,
                             VkDeviceAddress positions) {
  const scene::TriangleRange& range = scene.ranges[number];
  std::vector<uint32_t> list;
  list.reserve(3 * (size_t{range.opaque} + range.masked));
  for (uint32_t t = range.first; t < range.first + range.opaque + range.masked; ++t) {
    list.insert(list.end(), std::begin(scene.triangles[t].v), std::end(scene.triangles[t].v));
  }
  indices = gpu::uploadBuffer(device, list, kBuildInput, "acceleration structure indices");
  auto add = [&](uint32_t first, uint32_t count, bool opaque) {
    VkAccelerationStructureGeometryKHR g{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR};
    g.geometryType = VK_GEOMETRY_TYPE_TRIANGLES_KHR;
    // Transmittance multiplies once a surface: a second any-hit call for the same triangle would count it twice.
    g.flags = opaque ? VK_GEOMETRY_OPAQUE_BIT_KHR : VK_GEOMETRY_NO_DUPLICATE_ANY_HIT_INVOCATION_BIT_KHR;
    auto& t = g.geometry.triangles;
    t.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_TRIANGLES_DATA_KHR;
    t.vertexFormat = VK_FORMAT_R32G32B32_SFLOAT;
    t.vertexData.deviceAddress = positions;
    t.vertexStride = sizeof(glm::vec3);
    t.maxVertex = scene.positions.empty() ? 0 : static_cast<uint32_t>(scene.positions.size() - 1);
    t.indexType = VK_INDEX_TYPE_UINT32;
    t.indexData.deviceAddress = indices.address() + uint64_t{first} * 3 * sizeof(uint32_t);
    geometries.push_back(g);
    counts.push_back(count);
  };
  // Geometry 1 must be the one with alpha even when there are no opaque triangles: shaders count on it.
  add(0, range.opaque, true);
  if (range.masked > 0) add(range.opaque, range.masked, false);
}

VkAccelerationStructureBuildGeometryInfoKHR RangeGeometry::info() const {
  VkAccelerationStructureBuildGeometryInfoKHR info{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR};
  info.type = VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR;
  info.flags = VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_TRACE_BIT_KHR;
  info.mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR;
  info.geometryCount = static_cast<uint32_t>(geometries.size());
  info.pGeometries = geometries.data();
  return info;
}

InstanceGeometry::InstanceGeometry(VkDeviceAddress instances) {
  geometry.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR;
  geometry.geometryType = VK_GEOMETRY_TYPE_INSTANCES_KHR;
  geometry.geometry.instances.sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_INSTANCES_DATA_KHR;
  geometry.geometry.instances.data.deviceAddress = instances;
}

VkAccelerationStructureBuildGeometryInfoKHR InstanceGeometry::info() const {
  VkAccelerationStructureBuildGeometryInfoKHR info{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR};
  info.type = VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR;
  info.flags = VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_TRACE_BIT_KHR;
  info.mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR;
  info.geometryCount = 1;
  info.pGeometries = &geometry;
  return info;
}

VkAccelerationStructureInstanceKHR instanceOf(const scene::PreparedScene& scene, size_t number,
                                              const glm::mat4& toWorld, VkDeviceAddress bottom) {
  VkAccelerationStructureInstanceKHR instance{};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) instance.transform.matrix[row][column] = toWorld[column][row];
  }
  instance.instanceCustomIndex = static_cast<uint32_t>(number);
  instance.mask = 0xff;
  // Facing is decided in object space, where glTF's fronts are counter-clockwise, as are Vulkan's: a mirroring
  // transform turns the ray's side along with the winding.
  if (scene.ranges[scene.instances[number].range].doubleSided)
    instance.flags = VK_GEOMETRY_INSTANCE_TRIANGLE_FACING_CULL_DISABLE_BIT_KHR;
  instance.accelerationStructureReference = bottom;
  return instance;
}

VkAccelerationStructureBuildSizesInfoKHR buildSizes(const gpu::Device& device,
                                                    const VkAccelerationStructureBuildGeometryInfoKHR& info,
                                                    const std::vector<uint32_t>& counts) {
  VkAccelerationStructureBuildSizesInfoKHR sizes{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR};
  vkGetAccelerationStructureBuildSizesKHR(device.handle(), VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR, &info,
                                          counts.data(), &sizes);
  return sizes;
}

Structure buildNow(const gpu::Device& device, VkAccelerationStructureBuildGeometryInfoKHR info,
                   const std::vector<uint32_t>& counts, const std::string& name) {
  const VkAccelerationStructureBuildSizesInfoKHR sizes = buildSizes(device, info, counts);
  Structure s(device, info.type, sizes.accelerationStructureSize, name);
  const gpu::Buffer scratch(device, sizes.buildScratchSize,
                            VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                            gpu::Residency::Device, name + " scratch", device.capabilities().minScratchAlignment);
  info.dstAccelerationStructure = s.handle();
  info.scratchData.deviceAddress = scratch.address();
  std::vector<VkAccelerationStructureBuildRangeInfoKHR> ranges(counts.size());
  for (size_t i = 0; i < counts.size(); ++i) ranges[i].primitiveCount = counts[i];
  const VkAccelerationStructureBuildRangeInfoKHR* rangePointer = ranges.data();
  device.submitAndWait([&](VkCommandBuffer commands) {
    gpu::fullBarrier(commands);
    vkCmdBuildAccelerationStructuresKHR(commands, 1, &info, &rangePointer);
    gpu::fullBarrier(commands);
  });
  return s;
}

}  // namespace weir::trace
