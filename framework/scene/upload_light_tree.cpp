#include <weir/scene/light_tree.h>
#include <weir/scene/upload_light_tree.h>

#include <cstring>
#include <utility>
#include <vector>

namespace weir::scene {

LightTreeGpu::LightTreeGpu(const gpu::Device& device, const PreparedScene& prepared) {
  const LightTree tree = buildLightTree(prepared.lights, prepared.bounds);
  constexpr VkBufferUsageFlags kStorage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT;
  nodes_ = gpu::uploadBuffer(device, tree.nodes, kStorage, "scene light tree");
  lights_ = gpu::uploadBuffer(device, tree.lights, kStorage, "scene light tree's lights");
  GpuTreeHead head;
  head.lights = static_cast<uint32_t>(tree.lights.size());
  head.unplaced = tree.unplaced();
  head.levels = tree.levels;
  head.cutLevels = tree.cutLevels;
  head.unplacedShare = tree.unplacedShare;
  head.origin = tree.origin;
  head.unit = tree.unit;
  std::vector<std::byte> bytes(sizeof head + tree.entries.size() * sizeof(TreeEntry));
  std::memcpy(bytes.data(), &head, sizeof head);
  if (!tree.entries.empty())
    std::memcpy(bytes.data() + sizeof head, tree.entries.data(), tree.entries.size() * sizeof(TreeEntry));
  entries_ = gpu::uploadBuffer(device, bytes, kStorage, "scene light tree's entries");
}

void LightTreeGpu::update(const gpu::Device& device, const PreparedScene& prepared) {
  const LightTreeGpu fresh(device, prepared);
  device.submitAndWait([&](VkCommandBuffer commands) {
    gpu::fullBarrier(commands);
    for (const auto& [from, to] :
         {std::pair(&fresh.nodes_, &nodes_), {&fresh.lights_, &lights_}, {&fresh.entries_, &entries_}}) {
      const VkBufferCopy all{0, 0, to->size()};
      vkCmdCopyBuffer(commands, from->handle(), to->handle(), 1, &all);
    }
    gpu::fullBarrier(commands);
  });
}

}  // namespace weir::scene
