// Buffer layouts that passes of several plugins share. The GLSL structs are generated from these.
#pragma once

#include <weir/pass/description.h>

#include <array>
#include <cstdint>

namespace weir::passes {

/// The first visible surface of a pixel: 24 bytes, what neighbour tests need in the first 16. distance 0: nothing was
/// hit. What is rounded, but for the geometric normal, is rounded up or down at random by pixel, frame and seed, so
/// that its mean is what it was (shaders/common/rounding.glsl).
struct PackedSurface {
  float distance;            ///< along the ray, metres
  uint32_t geometricNormal;  ///< octahedral 2 × snorm16, faces the viewer
  uint32_t shadingNormal;    ///< likewise
  uint32_t diffuse;          ///< c_diff: 11 + 11 + 10 bits, square-root spaced
  uint32_t specular;         ///< F0, likewise
  /// Roughness unorm16 above, sample place in the pixel 2 × 8 bits below (127: centre). In scenes with the trait f90
  /// the upper half is roughness unorm10 above F90 unorm6.
  uint32_t roughnessJitter;
};

/// A reservoir of one light sample: 16 bytes. All zero is the empty reservoir: it adds nothing and has no confidence.
struct Reservoir {
  /// Light index below 2^30. The top bit: the sample was seen from the reservoir's own pixel by a shadow ray; the one
  /// below it: it was hidden from there in the last frame, a hint.
  uint32_t light;
  uint32_t place;    ///< where on the light, 2 × 16 bits
  float weight;      ///< W, the unbiased contribution weight: per m² for triangles; 0: no sample
  float confidence;  ///< c, in fresh frames
};

/// Running mean of a picture, compensated so that a million frames lose nothing.
struct MeanState {
  float sumHigh[3], sumLow[3];
  float count;
  float pad;
};

}  // namespace weir::passes

namespace weir {

template <>
struct LayoutOf<passes::PackedSurface> {
  static constexpr const char* name = "PackedSurface";
  static constexpr uint32_t version = 1, emptyWord = 0;
  static constexpr std::array<Field, 6> fields{{{"float", "distance"},
                                                {"uint", "geometricNormal"},
                                                {"uint", "shadingNormal"},
                                                {"uint", "diffuse"},
                                                {"uint", "specular"},
                                                {"uint", "roughnessJitter"}}};
};

template <>
struct LayoutOf<passes::Reservoir> {
  static constexpr const char* name = "Reservoir";
  static constexpr uint32_t version = 1, emptyWord = 0;
  static constexpr std::array<Field, 4> fields{
      {{"uint", "light"}, {"uint", "place"}, {"float", "weight"}, {"float", "confidence"}}};
};

template <>
struct LayoutOf<passes::MeanState> {
  static constexpr const char* name = "MeanState";
  static constexpr uint32_t version = 1, emptyWord = 0;
  static constexpr std::array<Field, 8> fields{{{"float", "highR"},
                                                {"float", "highG"},
                                                {"float", "highB"},
                                                {"float", "lowR"},
                                                {"float", "lowG"},
                                                {"float", "lowB"},
                                                {"float", "count"},
                                                {"float", "pad"}}};
};

}  // namespace weir
