// One acceleration structure, and the descriptions that builds of it take. Internal to trace.
#pragma once

#include <weir/gpu/memory.h>
#include <weir/scene/prepared.h>

#include <string>
#include <vector>

namespace weir::trace {

inline constexpr VkBufferUsageFlags kBuildInput =
    VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;

/// Moves only; frees itself.
class Structure {
 public:
  Structure() = default;
  Structure(const gpu::Device& device, VkAccelerationStructureTypeKHR type, uint64_t size, const std::string& name);
  ~Structure();
  Structure(Structure&& other) noexcept;
  Structure& operator=(Structure&& other) noexcept;

  VkAccelerationStructureKHR handle() const { return handle_; }
  VkDeviceAddress address() const { return address_; }
  uint64_t bytes() const { return handle_ == VK_NULL_HANDLE ? 0 : buffer_.size(); }

 private:
  const gpu::Device* device_ = nullptr;
  gpu::Buffer buffer_;
  VkAccelerationStructureKHR handle_ = VK_NULL_HANDLE;
  VkDeviceAddress address_ = 0;
};

/// What a bottom-level build of one triangle range reads. Keeps the tightly packed indices that Vulkan wants (shaders
/// read theirs beside the material): it must live until the build is done.
struct RangeGeometry {
  RangeGeometry(const gpu::Device& device, const scene::PreparedScene& scene, size_t range, VkDeviceAddress positions);
  /// A full build; points into this object.
  VkAccelerationStructureBuildGeometryInfoKHR info() const;

  gpu::Buffer indices;
  std::vector<VkAccelerationStructureGeometryKHR> geometries;
  std::vector<uint32_t> counts;  ///< triangles of each
};

/// What a top-level build reads: VkAccelerationStructureInstanceKHR, tightly packed.
struct InstanceGeometry {
  explicit InstanceGeometry(VkDeviceAddress instances);
  VkAccelerationStructureBuildGeometryInfoKHR info() const;
  VkAccelerationStructureGeometryKHR geometry{};
};

VkAccelerationStructureInstanceKHR instanceOf(const scene::PreparedScene& scene, size_t instance,
                                              const glm::mat4& toWorld, VkDeviceAddress bottom);

VkAccelerationStructureBuildSizesInfoKHR buildSizes(const gpu::Device& device,
                                                    const VkAccelerationStructureBuildGeometryInfoKHR& info,
                                                    const std::vector<uint32_t>& counts);

/// Builds in a submission of its own and waits.
Structure buildNow(const gpu::Device& device, VkAccelerationStructureBuildGeometryInfoKHR info,
                   const std::vector<uint32_t>& counts, const std::string& name);

}  // namespace weir::trace
