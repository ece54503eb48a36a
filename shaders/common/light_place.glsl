// A point on a light in 32 bits, so that it is the same point wherever a reservoir carries it.
#ifndef WEIR_LIGHT_PLACE
#define WEIR_LIGHT_PLACE

#include "mutants.glsl"

// 32-bit place on a light from two uniform numbers.
uint packPlace(vec2 u) { return uint(u.x * 65536.0) | (uint(u.y * 65536.0) << 16u); }

// The middle of the place's cell in the unit square.
vec2 unpackPlace(uint place) { return (vec2(place & 0xffffu, place >> 16u) + 0.5) / 65536.0; }

// Barycentrics of vertices 1 and 2, uniform over the triangle: places fill the parallelogram of both edges evenly, and its far half is
// folded onto the near one along the edge between them, across which places stay neighbours. So they are 1/65536 of a side apart
// everywhere; by a square root (Osada et al. 2002) they would be 1/256 apart at vertex 0, and a surface close to it would see a light of
// few points.
vec2 placeOnTriangle(uint place) {
  vec2 u = unpackPlace(place);
  u.x = MUTANT(40, pow(u.x, 0.9), u.x);
  return u.x + u.y > 1.0 ? 1.0 - u.yx : u;
}

#endif
