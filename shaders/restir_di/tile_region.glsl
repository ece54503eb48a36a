// What the surfaces of a tile of 16 × 16 pixels span, found by its workgroup together.
#ifndef WEIR_TILE_REGION
#define WEIR_TILE_REGION

#include "light_tree.glsl"
#include "surface.glsl"

const uint kTilePixels = 256u, kParts = 16u, kBounds = 12u;
const float kNothing = 3.4028235e38;

// Least of each number: of positions, negated positions, normals, negated normals.
shared float tileBounds[kBounds * kTilePixels];
shared float partBounds[kBounds * kParts];

void setBounds(uint at, vec3 v) {
  for (uint axis = 0u; axis < 3u; ++axis) {
    tileBounds[(at + axis) * kTilePixels + gl_LocalInvocationIndex] = v[axis];
    tileBounds[(at + 3u + axis) * kTilePixels + gl_LocalInvocationIndex] = -v[axis];
  }
}

// All of a group must call it. False, for all alike: there is no surface. It depends on surfaces alone.
bool tileRegion(bool lit, Surface surface, out Region region) {
  const uint thread = gl_LocalInvocationIndex;
  if (lit) {
    setBounds(0u, surface.position);
    setBounds(6u, MUTANT(84, surface.view, surface.geometricNormal));
  } else {
    for (uint i = 0u; i < kBounds; ++i) tileBounds[i * kTilePixels + thread] = kNothing;
  }
  barrier();
  if (thread < kBounds * kParts) {
    const uint first = thread / kParts * kTilePixels + thread % kParts;
    float least = kNothing;
    for (uint i = 0u; i < MUTANT(85, kTilePixels / 2u, kTilePixels); i += kParts) least = min(least, tileBounds[first + i]);
    partBounds[thread] = least;
  }
  barrier();
  if (thread < kBounds) {
    float least = kNothing;
    for (uint i = 0u; i < kParts; ++i) least = min(least, partBounds[thread * kParts + i]);
    tileBounds[thread] = least;
  }
  barrier();
  region.low = vec3(tileBounds[0], tileBounds[1], tileBounds[2]);
  region.high = -vec3(tileBounds[3], tileBounds[4], tileBounds[5]);
  region.normalLow = vec3(tileBounds[6], tileBounds[7], tileBounds[8]);
  region.normalHigh = -vec3(tileBounds[9], tileBounds[10], tileBounds[11]);
  return region.low.x <= region.high.x;
}

#endif
