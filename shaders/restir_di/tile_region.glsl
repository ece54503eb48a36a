// What the surfaces of a tile of 16 × 16 pixels span, found by its workgroup together.
#ifndef WEIR_TILE_REGION
#define WEIR_TILE_REGION

#include "light_tree.glsl"
#include "surface.glsl"

const uint kTilePixels = 256u, kGroups = 16u, kSides = 6u;
const float kNothing = 3.4028235e38;

// The least of each number: of a vector's parts and of their negatives, as bits of floats; tile_cut.glsl uses the memory again.
// Together with the picks they fit into the 16 KiB that every device has.
shared uint tileWords[kSides * kTilePixels];
shared uint groupWords[kSides * kGroups];
shared float boxSides[2u * kSides];

// All of a workgroup must call it, and wait with barrier() before they read the sides from `first` on.
void gatherSides(uint first, bool lit, vec3 v) {
  const uint thread = gl_LocalInvocationIndex;
  for (uint axis = 0u; axis < 3u; ++axis) {
    tileWords[axis * kTilePixels + thread] = floatBitsToUint(lit ? v[axis] : kNothing);
    tileWords[(axis + 3u) * kTilePixels + thread] = floatBitsToUint(lit ? -v[axis] : kNothing);
  }
  barrier();
  if (thread < kSides * kGroups) {
    const uint begin = thread / kGroups * kTilePixels + thread % kGroups;
    float least = kNothing;
    const uint end = begin + MUTANT(85, kTilePixels / 2u, kTilePixels);
    for (uint i = begin; i < end; i += kGroups) least = min(least, uintBitsToFloat(tileWords[i]));
    groupWords[thread] = floatBitsToUint(least);
  }
  barrier();
  if (thread < kSides) {
    float least = kNothing;
    for (uint i = 0u; i < kGroups; ++i) least = min(least, uintBitsToFloat(groupWords[thread * kGroups + i]));
    boxSides[first + thread] = least;
  }
}

// All of a workgroup must call it. False, for all alike: there is no surface. It depends on surfaces alone.
bool gatherRegion(bool lit, Surface surface) {
  gatherSides(0u, lit, surface.position);
  gatherSides(kSides, lit, MUTANT(84, surface.view, surface.geometricNormal));
  barrier();
  return boxSides[0] <= -boxSides[3];
}

// What gatherRegion() found. Cheap to work out again, where it would hold registers.
Region tileRegion() {
  return regionOf(vec3(boxSides[0], boxSides[1], boxSides[2]), -vec3(boxSides[3], boxSides[4], boxSides[5]),
                  vec3(boxSides[6], boxSides[7], boxSides[8]), -vec3(boxSides[9], boxSides[10], boxSides[11]));
}

#endif
