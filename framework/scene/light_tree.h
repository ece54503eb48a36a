// A tree over the lights of a scene that have a place, from which surfaces pick lights by power and distance: Conty
// Estevez and Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting". Plain data, as shaders
// read it; shaders/common/light_tree.glsl descends it, docs/lights.md says how.
#pragma once

#include <weir/scene/lights.h>

#include <cstdint>
#include <span>
#include <vector>

namespace weir::scene {

/// A node, 32 bytes. Children of node i are 2i and 2i + 1, side by side; the root is 1.
struct LightNode {
  glm::vec3 low{0.0f};  ///< corners of a box around all of the lights under it, m
  float power = 0.0f;   ///< Σ of theirs
  glm::vec3 high{0.0f};
  uint32_t lights = 0;  ///< of a leaf: the first one's place in LightTree::lights + how many << kLeafShift
};
static_assert(sizeof(LightNode) == 32);
inline constexpr uint32_t kLeafShift = 28;

/// What choosing among the lights of a leaf looks at, 16 bytes.
struct PlacedLight {
  glm::vec3 centre{0.0f};  ///< of a triangle its centroid
  float power = 0.0f;      ///< share of the power of all lights of the scene; at least 2⁻²⁴ of the mean share
};
static_assert(sizeof(PlacedLight) == 16);

/// Which light it is, 8 bytes.
struct TreeEntry {
  uint32_t light = 0;  ///< into PreparedScene::lights
  /// Of a placed light: the float that is the radius of a sphere around its centre that holds it, m; 0: a point.
  /// Of one without a place: the last of the 2³² numbers that pick it.
  uint32_t bits = 0;
};
static_assert(sizeof(TreeEntry) == 8);

struct LightTree {
  static constexpr uint32_t kMostInLeaf = 8;
  static constexpr uint32_t kMostLights = 1u << kLeafShift;

  uint32_t levels = 0;           ///< below the root: there are 2^levels leaves, whose counts differ by one at most
  std::vector<LightNode> nodes;  ///< 2 · 2^levels; [0] is unused. Without placed lights a root without power
  std::vector<PlacedLight> lights;
  std::vector<TreeEntry> entries;  ///< beside `lights`; then, in the table's order, lights without a place
  /// Share of the picks that go to lights without a place, in parts of 2²⁴: that of their power, but at least a quarter
  /// and at most three; 0 or 2²⁴ where all lights are of one kind.
  uint32_t unplacedShare = 0;
  /// Lengths are multiplied by it, so that their squares are in range: a power of two. The longest side of the box
  /// around scene and lights becomes about 1.
  float unit = 1.0f;

  uint32_t unplaced() const { return static_cast<uint32_t>(entries.size() - lights.size()); }
};

/// Whether a light has a place: all but directional ones and environments.
bool hasPlace(const GpuLight& light);

/// Builds the tree: 1 s for two million lights on two cores, in O(n log n). Deterministic. `bounds` is the scene's.
/// InputError when a light's place is not finite or there are more than kMostLights.
LightTree buildLightTree(std::span<const GpuLight> lights, const Bounds& bounds);

}  // namespace weir::scene
