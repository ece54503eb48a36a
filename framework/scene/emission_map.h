// Means of a triangle's emission and coverage under its textures. Internal to scene/gather_lights.
#pragma once

#include <weir/scene/scene.h>

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

namespace weir::scene {

/// Summed-area table (Crow 1984) of a number for each texel, in integers: sums are exact, so a region has none of it if
/// and only if its sum is zero.
class TexelSums {
 public:
  /// Mean over the texels in the bounding box of the coordinates, grown by a texel for filtering. Exactly 0 only if all
  /// of them are 0.
  double mean(const glm::vec2& a, const glm::vec2& b, const glm::vec2& c) const;

 protected:
  /// `most`: what the largest number that fill() is given stands for.
  TexelSums(const Image& image, Wrap wrapS, Wrap wrapT, double most);
  /// `value(texel)` is the number times kUnit, at most kUnit; `texel` are the four codes.
  template <typename Value>
  void fill(const Image& image, const Value& value);
  static constexpr double kUnit = 4294967296.0;  ///< 2^32 a texel times 2^28 texels (16384²) stays below 2^64

 private:
  uint64_t sum(uint32_t x, uint32_t y) const { return table_[static_cast<size_t>(y) * (width_ + 1) + x]; }

  uint32_t width_, height_;
  Wrap wrapS_, wrapT_;
  double scale_;  // what one unit of the table stands for
  std::vector<uint64_t> table_;
};

/// luminance(factor · texel) of an sRGB texture, in the factor's unit.
class EmissionMap : public TexelSums {
 public:
  EmissionMap(const Image& image, Wrap wrapS, Wrap wrapT, const glm::vec3& factor);
};

/// Coverage, 0 … 1, by factor · alpha of a texture: that itself or, with a cutoff, whether it comes up to that.
/// Filtering makes no alpha that is more than that of the texels around, so that what counts as bare never covers
/// anything.
class CoverageMap : public TexelSums {
 public:
  CoverageMap(const Image& image, Wrap wrapS, Wrap wrapT, float factor, std::optional<float> cutoff);
};

/// sRGB code value to linear (IEC 61966-2-1).
float srgbToLinear(uint8_t code);

}  // namespace weir::scene
