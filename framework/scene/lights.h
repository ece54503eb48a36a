// Lights: one table for triangles and punctual lights, and the alias table that picks from it by power.
#pragma once

#include <weir/scene/scene.h>

#include <cstdint>
#include <vector>

namespace weir::scene {

/// Kinds in GpuLight::kind, as in shaders/common/lights.glsl.
enum class GpuLightKind : uint32_t { Point = 0, Spot = 1, Directional = 2, Triangle = 3, Environment = 4 };
inline constexpr uint32_t kLightDoubleSided = 1u << 8;
inline constexpr uint32_t kLightTextured = 1u << 9;
/// Corners 1 and 2 have changed places, since the triangle's instance mirrors: only lights that move.
inline constexpr uint32_t kLightTurned = 1u << 10;
/// Coverage varies over the triangle (alpha mask or blending), and its emission with it. One that is the same all over
/// is part of the radiance.
inline constexpr uint32_t kLightAlpha = 1u << 11;
inline constexpr uint32_t kNoLight = 0xffffffffu;

/// One light, 64 bytes, as shaders read it: all that a point light has lies in the first 32, which are read at once.
/// Triangle: position = vertex 0, a = edge to vertex 1, b = edge to vertex 2 (world), radiance in nit.
/// Point and spot: position; a = direction of travel; b.x = 1/(cos inner - cos outer), b.y = cos outer,
/// b.z = range (0: none); radiance = candela. Directional: a = direction of travel; radiance = lux.
/// Environment: nothing but its kind; scene/environment.h has the rest.
struct GpuLight {
  glm::vec3 position{0.0f};
  uint32_t kind = 0;  ///< GpuLightKind, or-ed with kLight... flags
  glm::vec3 radiance{0.0f};
  float pdf = 0.0f;  ///< probability with which the alias table picks this light
  glm::vec3 a{0.0f};
  uint32_t triangle = 0xffffffffu;  ///< index into PreparedScene::triangles
  glm::vec3 b{0.0f};
  float area = 0.0f;  ///< m², triangles only
};
static_assert(sizeof(GpuLight) == 64);

/// One cell of the alias table (Vose 1991): with u uniform in [0,1), keep this cell's light if u < threshold, else take
/// `alias`.
struct AliasCell {
  float threshold = 1.0f;
  uint32_t alias = 0;
};
static_assert(sizeof(AliasCell) == 8);

/// Vose's method in O(n). Weights are non-negative and finite, in any scale; the table reproduces weight/sum to within
/// 1e-6 relative to 1/n. All weights zero: an empty table. NaN, infinite or negative weights throw InputError.
std::vector<AliasCell> buildAliasTable(const std::vector<double>& weights);

/// The exact probabilities that a table implements, for checks: p[i] = (threshold_i + Σ_{alias_j = i} (1 -
/// threshold_j)) / n.
std::vector<double> aliasProbabilities(const std::vector<AliasCell>& table);

/// `--lights N`: N point lights, positions uniform in the scene's bounds, colours uniform in [0,1]³ scaled so that the
/// total of their luminous intensity is kGeneratedIntensity · r² candela for bounding radius r, whatever N.
/// Counter-based from `seed`: the first k lights' positions are the same for every N ≥ k. Number d of light i is the
/// top 24 bits of mix(mix(mix(seed) ^ i) + d), mix being SplitMix64's step; d = 0, 1, 2 place it in the bounds, colour
/// c_i is d = 3, 4, 5, and intensity_i = c_i · kGeneratedIntensity · r² / Σ_j luminance(c_j). Throws InputError when
/// there is no geometry. Replaces nothing: the caller empties Scene::lights where asked.
void addGeneratedLights(Scene& scene, uint32_t count, uint32_t seed);
inline constexpr float kGeneratedIntensity = 10.0f;

/// Luminance of linear Rec.709.
inline float luminance(const glm::vec3& c) {
  return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
}

}  // namespace weir::scene
