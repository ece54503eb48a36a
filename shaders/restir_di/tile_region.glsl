// What the surfaces of a tile of 16 × 16 pixels span, found by its workgroup together.
#ifndef WEIR_TILE_REGION
#define WEIR_TILE_REGION

#include "light_tree.glsl"
#include "surface.glsl"

const uint kTilePixels = 256u, kParts = 16u, kSides = 6u;
const float kNothing = 3.4028235e38;

// The least of each number: of a vector's parts and of their negatives. Together with the picks they fit into the 16 KiB that
// every device has.
shared float tileSides[kSides * kTilePixels];
shared float partSides[kSides * kParts];
shared float boxSides[2u * kSides];

// All of a group must call it, and wait with barrier() before they read the sides from `first` on.
void gatherSides(uint first, bool lit, vec3 v) {
  const uint thread = gl_LocalInvocationIndex;
  for (uint axis = 0u; axis < 3u; ++axis) {
    tileSides[axis * kTilePixels + thread] = lit ? v[axis] : kNothing;
    tileSides[(axis + 3u) * kTilePixels + thread] = lit ? -v[axis] : kNothing;
  }
  barrier();
  if (thread < kSides * kParts) {
    const uint begin = thread / kParts * kTilePixels + thread % kParts;
    float least = kNothing;
    for (uint i = 0u; i < MUTANT(85, kTilePixels / 2u, kTilePixels); i += kParts) least = min(least, tileSides[begin + i]);
    partSides[thread] = least;
  }
  barrier();
  if (thread < kSides) {
    float least = kNothing;
    for (uint i = 0u; i < kParts; ++i) least = min(least, partSides[thread * kParts + i]);
    boxSides[first + thread] = least;
  }
}

// All of a group must call it. False, for all alike: there is no surface. It depends on surfaces alone.
bool tileRegion(bool lit, Surface surface, out Region region) {
  gatherSides(0u, lit, surface.position);
  gatherSides(kSides, lit, MUTANT(84, surface.view, surface.geometricNormal));
  barrier();
  region.low = vec3(boxSides[0], boxSides[1], boxSides[2]);
  region.high = -vec3(boxSides[3], boxSides[4], boxSides[5]);
  region.normalLow = vec3(boxSides[6], boxSides[7], boxSides[8]);
  region.normalHigh = -vec3(boxSides[9], boxSides[10], boxSides[11]);
  return region.low.x <= region.high.x;
}

#endif
