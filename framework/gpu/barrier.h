// The one kind of barrier that Weir records: memory made visible between stages; images stay in one layout.
#pragma once

#include <weir/gpu/vulkan.h>

namespace weir::gpu {

/// What `before` wrote or read by `beforeAccess` happens before `after` does so by `afterAccess`.
inline void memoryBarrier(VkCommandBuffer commands, VkPipelineStageFlags2 before, VkAccessFlags2 beforeAccess,
                          VkPipelineStageFlags2 after, VkAccessFlags2 afterAccess) {
  VkMemoryBarrier2 memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
  memory.srcStageMask = before;
  memory.srcAccessMask = beforeAccess;
  memory.dstStageMask = after;
  memory.dstAccessMask = afterAccess;
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.memoryBarrierCount = 1;
  info.pMemoryBarriers = &memory;
  vkCmdPipelineBarrier2(commands, &info);
}

}  // namespace weir::gpu
