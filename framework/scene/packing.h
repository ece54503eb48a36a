// Octahedral unit vectors in 32 bits, as PackedVertex stores them and shaders/common decodes them.
// Source: Cigolle et al. 2014, "A Survey of Efficient Representations for Independent Unit Vectors".
// Error of a decoded direction (measured by tests/scene): normals below 5e-5 rad, tangents below 1e-4 rad.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

namespace weir::scene {

/// Unit vector to the square [-1,1]². A zero or non-finite vector gives (0,0), which is +Z.
inline glm::vec2 octahedral(const glm::vec3& v) {
  const float sum = std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
  if (!(sum > 0.0f) || !std::isfinite(sum)) return {0.0f, 0.0f};
  const glm::vec2 p(v.x / sum, v.y / sum);
  if (v.z >= 0.0f) return p;
  return {(1.0f - std::abs(p.y)) * (p.x >= 0.0f ? 1.0f : -1.0f), (1.0f - std::abs(p.x)) * (p.y >= 0.0f ? 1.0f : -1.0f)};
}

/// The square back to a unit vector.
inline glm::vec3 fromOctahedral(const glm::vec2& e) {
  glm::vec3 v(e.x, e.y, 1.0f - std::abs(e.x) - std::abs(e.y));
  const float fold = std::max(-v.z, 0.0f);
  v.x += v.x >= 0.0f ? -fold : fold;
  v.y += v.y >= 0.0f ? -fold : fold;
  return glm::normalize(v);
}

/// [-1,1] to a signed integer of `bits` bits, two's complement in the low bits.
inline uint32_t packSnorm(float value, int bits) {
  const float scale = static_cast<float>((1 << (bits - 1)) - 1);
  const int quantised = static_cast<int>(std::lround(std::clamp(value, -1.0f, 1.0f) * scale));
  return static_cast<uint32_t>(quantised) & ((1u << bits) - 1u);
}

/// The inverse of packSnorm; higher bits of `packed` are ignored.
inline float unpackSnorm(uint32_t packed, int bits) {
  const int value = static_cast<int>(packed << (32 - bits)) >> (32 - bits);
  return std::max(static_cast<float>(value) / static_cast<float>((1 << (bits - 1)) - 1), -1.0f);
}

/// PackedVertex::normal: x in the low, y in the high 16 bits.
inline uint32_t packNormal(const glm::vec3& normal) {
  const glm::vec2 e = octahedral(normal);
  return packSnorm(e.x, 16) | (packSnorm(e.y, 16) << 16);
}

inline glm::vec3 unpackNormal(uint32_t packed) {
  return fromOctahedral({unpackSnorm(packed, 16), unpackSnorm(packed >> 16, 16)});
}

/// PackedVertex::tangent: x in bits 0-15, bit 16 set when w is negative, y in bits 17-31.
inline uint32_t packTangent(const glm::vec4& tangent) {
  const glm::vec2 e = octahedral(glm::vec3(tangent));
  return packSnorm(e.x, 16) | (tangent.w < 0.0f ? 1u << 16 : 0u) | (packSnorm(e.y, 15) << 17);
}

inline glm::vec4 unpackTangent(uint32_t packed) {
  const glm::vec3 t = fromOctahedral({unpackSnorm(packed, 16), unpackSnorm(packed >> 17, 15)});
  return {t, (packed >> 16) & 1u ? -1.0f : 1.0f};
}

}  // namespace weir::scene
