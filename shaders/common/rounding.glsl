// Uniform numbers that a surface's values are rounded by where they are packed (packing.glsl). They follow from pixel, frame and seed
// alone, so that every G-buffer rounds alike, and are independent of each other and of whatever passes draw: estimators are linear in
// c_diff and F0 (and in their product), so their mean over frames is what unrounded values would give.
#ifndef WEIR_ROUNDING
#define WEIR_ROUNDING

#include "random.glsl"

struct Rounding {
  vec3 diffuse, specular;
  float roughness, f90;
  vec2 normal;
};

// 16 bits are enough: a probability that is off by 2^-17 moves the mean by that part of a step.
vec2 halves(uint bits) { return (vec2(bits & 0xffffu, bits >> 16u) + 0.5) / 65536.0; }

// Passes count their dimensions up from 0 and never reach these.
const uint kRoundingDimension = 0x80000000u;

Rounding roundingFor(uvec2 pixel) {
  const uint place = pixel.x | (pixel.y << 16u);
  const uvec4 a = pcg4d(uvec4(place, frameIndex, frameSeed, kRoundingDimension));
  const uvec4 b = pcg4d(uvec4(place, frameIndex, frameSeed, kRoundingDimension + 1u));
  const vec2 middle = halves(a.y), last = halves(a.w);
  return Rounding(vec3(halves(a.x), middle.x), vec3(halves(a.z), middle.y), last.x, last.y, halves(b.x));
}

#endif
