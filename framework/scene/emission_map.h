// Mean emission of a triangle under an emissive texture. Internal to scene/gather_lights.
#pragma once

#include <weir/scene/scene.h>

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace weir::scene {

/// Summed-area table (Crow 1984) of luminance(factor · texel) for one sRGB texture, in integers: sums are exact, so a
/// region is black if and only if its sum is zero.
class EmissionMap {
 public:
  EmissionMap(const Image& image, Wrap wrapS, Wrap wrapT, const glm::vec3& factor);

  /// Mean luminance over the texels in the bounding box of the coordinates, grown by a texel for filtering. Same unit
  /// as the factor. Exactly 0 only if all of them are black.
  double mean(const glm::vec2& a, const glm::vec2& b, const glm::vec2& c) const;

 private:
  uint64_t sum(uint32_t x, uint32_t y) const { return table_[static_cast<size_t>(y) * (width_ + 1) + x]; }

  uint32_t width_, height_;
  Wrap wrapS_, wrapT_;
  double scale_;  // luminance of one unit of the table
  std::vector<uint64_t> table_;
};

/// sRGB code value to linear (IEC 61966-2-1).
float srgbToLinear(uint8_t code);

}  // namespace weir::scene
