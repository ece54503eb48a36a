// Shadow rays in an order in which neighbours go the same way. A kernel writes a key for each pixel's ray, order_rays.glsl sorts the keys of
// each region of 64 × 64 pixels, and a linear ray kernel shoots them: invocations that trace together then meet the same boxes and
// triangles, and pixels that need no ray leave no holes between others.
#ifndef WEIR_RAY_ORDER
#define WEIR_RAY_ORDER

#include "packing.glsl"

const uint kRegionSide = 64u, kRegionRays = 4096u;
const uint kRayKeys = 1024u;
const uint kNoRay = 0xffffffffu;

// Directions that are alike have keys that are: 5 + 5 bits of the octahedral map, interleaved. The last key is for pixels without a ray.
const uint kNoRayKey = kRayKeys - 1u;
uint rayKey(vec3 direction) {
  const uint packed = packNormal(direction) ^ 0x80008000u;  // in order from -1 to 1
  uint key = 0u;
  for (uint bit = 0u; bit < 5u; ++bit) {
    key |= ((packed >> (11u + bit)) & 1u) << (2u * bit);
    key |= ((packed >> (27u + bit)) & 1u) << (2u * bit + 1u);
  }
  return min(key, kNoRayKey - 1u);
}

// Whose ray the `id`-th is; false: nobody's.
bool pixelOfRay(uint id, out uvec2 pixel) {
  const uint place = scratch_order[id].bits, region = id / kRegionRays, across = (frameWidth + kRegionSide - 1u) / kRegionSide;
  pixel = uvec2(region % across, region / across) * kRegionSide + uvec2(place % kRegionSide, place / kRegionSide);
  return place != kNoRay;
}

#endif
