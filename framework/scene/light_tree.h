// A tree over the lights of a scene that have a place, from which surfaces pick lights by power and distance: Conty
// Estevez and Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting". Plain data, as shaders
// read it; shaders/common/light_tree.glsl descends it, docs/lights.md says how.
#pragma once

#include <weir/scene/lights.h>

#include <cstdint>
#include <span>
#include <vector>

namespace weir::scene {

/// A node, 16 bytes: a box around all of the lights under it, rounded outwards, and their power. Children of node i are
/// 2i and 2i + 1, side by side, and so are 4i … 4i + 3, their children; the root is 1. Coordinates are in tree units:
/// (place − LightTree::origin) · LightTree::unit + 1, in [1, 2).
struct LightNode {
  /// The box's middle as fractions of 1: x is the upper 21 bits of the first, y of the second; the lower 11 bits of
  /// both are z, those of the first its upper ones.
  uint32_t place[2] = {0, 0};
  /// Half of its sides, 10 bits each from x in the lowest on: bits 18 to 27 of a float from 2⁻³⁰ on.
  uint32_t half = 0;
  float power = 0.0f;  ///< Σ of the lights'
};
static_assert(sizeof(LightNode) == 16);

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
  static constexpr uint32_t kMostCutLevels = 10;
  static constexpr uint32_t kMostLights = 1u << 28;

  /// Below the root: there are 2^levels leaves. Leaf i holds the lights from ⌊i · n / 2^levels⌋ on.
  uint32_t levels = 0;
  /// Where picks begin, with a choice among all 2^cutLevels nodes; from there on every other level counts, so that
  /// levels − cutLevels is even.
  uint32_t cutLevels = 0;
  std::vector<LightNode> nodes;  ///< 2 · 2^levels; [0] is unused. Without placed lights a root without power
  std::vector<PlacedLight> lights;
  std::vector<TreeEntry> entries;  ///< beside `lights`; then, in the table's order, lights without a place
  /// Share of the picks that go to lights without a place, in parts of 2²⁴: that of their power, but at least a quarter
  /// and at most three; 0 or 2²⁴ where all lights are of one kind.
  uint32_t unplacedShare = 0;
  glm::vec3 origin{0.0f};  ///< least corner of the lights' box, m
  /// Of tree units a metre: a power of two, which makes the longest side of the box around scene and lights 1/2 to 1.
  float unit = 1.0f;

  uint64_t firstOf(uint64_t leaf) const { return (leaf * lights.size()) >> levels; }
  uint32_t unplaced() const { return static_cast<uint32_t>(entries.size() - lights.size()); }
};

/// Whether a light has a place: all but directional ones and environments.
bool hasPlace(const GpuLight& light);

/// Builds the tree: 1 s for two million lights on two cores, in O(n log n). Deterministic. `bounds` is the scene's.
/// InputError when a light's place is not finite or there are more than kMostLights.
LightTree buildLightTree(std::span<const GpuLight> lights, const Bounds& bounds);

}  // namespace weir::scene
