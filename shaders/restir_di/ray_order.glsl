// The shadow rays of a tile of 16 × 16 pixels, in an order in which neighbours go the same way: invocations that trace together then
// meet the same boxes and triangles, and pixels that need no ray leave no holes between others. A compute kernel with such workgroups
// puts its pixels' rays in order, a linear ray kernel shoots them.
#ifndef WEIR_RAY_ORDER
#define WEIR_RAY_ORDER

const uint kTileSide = 16u, kTileRays = 256u;
const uint kNoRay = 0xffffffffu;

#ifdef ORDERS_RAYS
shared uint rayCounts[kTileRays];

// Directions that are alike have keys that are: 4 + 4 bits of the octahedral map, interleaved. The last key is for pixels without a ray.
const uint kNoRayKey = kTileRays - 1u;
uint rayKey(vec3 direction) {
  const uint packed = packNormal(direction);
  uint key = 0u;
  for (uint bit = 0u; bit < 4u; ++bit) {
    key |= ((packed >> (12u + bit)) & 1u) << (2u * bit);
    key |= ((packed >> (28u + bit)) & 1u) << (2u * bit + 1u);
  }
  return min(key, kNoRayKey - 1u);
}

// Every invocation of the workgroup must call it, once. A counting sort; which of two like rays comes first is left to chance, and
// nothing depends on it.
void orderRay(uint key) {
  const uint thread = gl_LocalInvocationIndex, tile = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  rayCounts[thread] = 0u;
  barrier();
  const uint among = atomicAdd(rayCounts[key], 1u);
  barrier();
  for (uint step = 1u; step < kTileRays; step *= 2u) {
    const uint before = thread >= step ? rayCounts[thread - step] : 0u;
    barrier();
    rayCounts[thread] += before;
    barrier();
  }
  const uint place = (key > 0u ? rayCounts[key - 1u] : 0u) + among;
  scratch_order[tile * kTileRays + place].pixel = key == kNoRayKey ? kNoRay : thread;
}
#else
// Whose ray the `id`-th is; false: nobody's.
bool pixelOfRay(uint id, out uvec2 pixel) {
  const uint place = scratch_order[id].pixel, tile = id / kTileRays, across = (frameWidth + kTileSide - 1u) / kTileSide;
  pixel = uvec2(tile % across, tile / across) * kTileSide + uvec2(place % kTileSide, place / kTileSide);
  return place != kNoRay;
}
#endif

#endif
