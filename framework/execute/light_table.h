// The alias table of lights whose powers change, built on the device: what scene/lights.h's buildAliasTable does on the
// CPU, in parallel.
#pragma once

#include <weir/execute/pipelines.h>
#include <weir/shader/compiler.h>

#include <array>
#include <vector>

namespace weir::execute {

/// Where the probabilities go that the finished table gives the lights: one float a light, at `offset` + i · `stride`,
/// both in floats.
struct LightProbabilities {
  VkBuffer buffer = VK_NULL_HANDLE;
  uint32_t stride = 1, offset = 0;
};

/// Each light's share of the table is its power's to within a part in 10⁶, the probabilities are those of the table.
/// All powers zero: all lights alike. Powers that are negative or no finite number count as zero. The same powers
/// always give the same table.
class LightTable {
 public:
  /// Whether the device has what it takes: double precision in shaders.
  static bool supported(const gpu::Device& device);

  /// For `lights` > 0 lights. `powers`: one float a light, in any unit. `cells`: an AliasCell each. Both and the
  /// probabilities, of which there may be several buffers, are storage buffers that must outlive this.
  LightTable(const gpu::Device& device, shader::Compiler& compiler, uint32_t lights, VkBuffer powers, VkBuffer cells,
             const std::vector<LightProbabilities>& probabilities);
  ~LightTable();
  LightTable(const LightTable&) = delete;
  LightTable& operator=(const LightTable&) = delete;

  /// Builds it, and writes the probabilities into the buffer of that number. Compute shaders may write the powers
  /// before, once the caller's barrier has made them visible; the barrier behind it is the caller's, too.
  void record(VkCommandBuffer commands, uint32_t probabilities) const;
  uint64_t bytes() const;

 private:
  static constexpr uint32_t kStages = 6;
  void makeLayouts(uint32_t sets);
  void makeSet(VkDescriptorSet set, const std::array<VkBuffer, 7>& buffers) const;

  const gpu::Device& device_;
  uint32_t lights_, groups_;
  std::vector<LightProbabilities> probabilities_;
  gpu::Buffer sums_, parts_, steps_, order_;
  std::array<Pipeline, kStages> kernels_;
  VkDescriptorSetLayout setLayout_ = VK_NULL_HANDLE;
  VkPipelineLayout pipelineLayout_ = VK_NULL_HANDLE;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  std::vector<VkDescriptorSet> sets_;
};

}  // namespace weir::execute
