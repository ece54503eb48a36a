#include <weir/trace/moving_acceleration.h>

#include <algorithm>

namespace weir::trace {
namespace {

uint64_t alignUp(uint64_t value, uint64_t alignment) {
  return (value + alignment - 1) / alignment * alignment;
}

void waitForBuilds(VkCommandBuffer commands) {
  VkMemoryBarrier2 memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
  memory.srcStageMask = memory.dstStageMask = VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR;
  memory.srcAccessMask = VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR;
  memory.dstAccessMask =
      VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR | VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR;
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.memoryBarrierCount = 1;
  info.pMemoryBarriers = &memory;
  vkCmdPipelineBarrier2(commands, &info);
}

}  // namespace

MovingAcceleration::MovingAcceleration(const gpu::Device& device, const scene::PreparedScene& scene,
                                       const Acceleration& still, const std::array<VkDeviceAddress, 2>& positions)
    : scene_(scene), still_(still) {
  const uint64_t alignment = std::max<uint64_t>(1, device.capabilities().minScratchAlignment);
  uint64_t scratch = 0;
  const auto count = static_cast<uint32_t>(scene.instances.size());
  for (uint32_t h = 0; h < 2; ++h) {
    Half& half = halves_[h];
    scratch = 0;
    for (size_t r = 0; r < scene.ranges.size(); ++r) {
      half.bottomOfRange.push_back(-1);
      if (scene.ranges[r].deformation < 0) continue;
      half.bottomOfRange.back() = static_cast<int>(half.bottom.size());
      half.bottom.push_back({RangeGeometry(device, scene, r, positions[h]), {}, scratch});
      Bottom& bottom = half.bottom.back();
      const VkAccelerationStructureBuildSizesInfoKHR sizes =
          buildSizes(device, bottomInfo(bottom), bottom.geometry.counts);
      bottom.structure =
          Structure(device, VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, sizes.accelerationStructureSize,
                    "moving bottom-level structure " + std::to_string(r));
      scratch = alignUp(scratch + std::max(sizes.buildScratchSize, sizes.updateScratchSize), alignment);
    }
    half.instances = gpu::Buffer(device, count * sizeof(VkAccelerationStructureInstanceKHR),
                                 kBuildInput | VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Residency::Device,
                                 "moving top-level instances");
    const VkAccelerationStructureBuildSizesInfoKHR sizes =
        buildSizes(device, InstanceGeometry(half.instances.address()).info(), {count});
    half.top = Structure(device, VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR, sizes.accelerationStructureSize,
                         "moving top-level structure");
    topScratch_ = scratch;
    scratch += sizes.buildScratchSize;
  }
  scratch_ =
      gpu::Buffer(device, scratch, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                  gpu::Residency::Device, "moving structures' scratch", alignment);
  for (Half& half : halves_) layOutBuilds(half);
}

VkAccelerationStructureBuildGeometryInfoKHR MovingAcceleration::bottomInfo(const Bottom& bottom) const {
  VkAccelerationStructureBuildGeometryInfoKHR info = bottom.geometry.info();
  info.flags |= VK_BUILD_ACCELERATION_STRUCTURE_ALLOW_UPDATE_BIT_KHR;
  return info;
}

void MovingAcceleration::packInstances(const scene::SceneState& state, uint32_t h,
                                       std::span<VkAccelerationStructureInstanceKHR> into) const {
  const Half& half = halves_[h];
  for (size_t i = 0; i < scene_.instances.size(); ++i) {
    const uint32_t range = scene_.instances[i].range;
    const int own = half.bottomOfRange[range];
    into[i] =
        instanceOf(scene_, i, state.toWorld[i], own >= 0 ? half.bottom[own].structure.address() : still_.bottom(range));
  }
}

void MovingAcceleration::layOutBuilds(Half& half) const {
  for (const Bottom& bottom : half.bottom) {
    VkAccelerationStructureBuildGeometryInfoKHR info = bottomInfo(bottom);
    info.dstAccelerationStructure = bottom.structure.handle();
    info.scratchData.deviceAddress = scratch_.address() + bottom.scratch;
    half.build.push_back(info);
    info.mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_UPDATE_KHR;
    info.srcAccelerationStructure = bottom.structure.handle();
    half.refit.push_back(info);
    half.ranges.emplace_back();
    for (uint32_t count : bottom.geometry.counts) half.ranges.back().push_back({count, 0, 0, 0});
  }
  for (const auto& list : half.ranges) half.rangePointers.push_back(list.data());
}

void MovingAcceleration::record(VkCommandBuffer commands, uint32_t h, bool fresh) const {
  const Half& half = halves_[h];
  // Before the first build of this frame, the builds of the frame before may still use the scratch memory.
  waitForBuilds(commands);
  const auto& infos = fresh ? half.build : half.refit;
  if (!infos.empty()) {
    vkCmdBuildAccelerationStructuresKHR(commands, static_cast<uint32_t>(infos.size()), infos.data(),
                                        half.rangePointers.data());
    waitForBuilds(commands);
  }
  const InstanceGeometry geometry(half.instances.address());
  VkAccelerationStructureBuildGeometryInfoKHR info = geometry.info();
  info.dstAccelerationStructure = half.top.handle();
  info.scratchData.deviceAddress = scratch_.address() + topScratch_;
  const VkAccelerationStructureBuildRangeInfoKHR range{static_cast<uint32_t>(scene_.instances.size()), 0, 0, 0};
  const VkAccelerationStructureBuildRangeInfoKHR* pointer = &range;
  vkCmdBuildAccelerationStructuresKHR(commands, 1, &info, &pointer);
}

uint64_t MovingAcceleration::bytes() const {
  uint64_t sum = scratch_.size();
  for (const Half& half : halves_) {
    sum += half.top.bytes() + half.instances.size();
    for (const Bottom& bottom : half.bottom) sum += bottom.structure.bytes() + bottom.geometry.indices.size();
  }
  return sum;
}

}  // namespace weir::trace
