// Sorts the rays of a region by their keys: a counting sort in a workgroup's shared memory, four pixels an invocation. Which of two like
// rays comes first is left to chance, and nothing depends on it.
#include "ray_order.glsl"

shared uint counts[kRayKeys];

void run(uvec2 id) {
  const uint thread = gl_LocalInvocationIndex;  // as many as there are keys
  const uvec2 corner = gl_WorkGroupID.xy * kRegionSide;
  counts[thread] = 0u;
  barrier();
  uint keys[4], among[4];
  for (uint i = 0u; i < 4u; ++i) {
    const uint at = i * kRayKeys + thread;
    const uvec2 pixel = corner + uvec2(at % kRegionSide, at / kRegionSide);
    keys[i] = kNoRayKey;
    if (all(lessThan(pixel, uvec2(frameSize)))) keys[i] = scratch_keys[pixel.y * frameWidth + pixel.x].bits;
    among[i] = atomicAdd(counts[keys[i]], 1u);
  }
  barrier();
  for (uint step = 1u; step < kRayKeys; step *= 2u) {
    const uint before = thread >= step ? counts[thread - step] : 0u;
    barrier();
    counts[thread] += before;
    barrier();
  }
  const uint region = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  for (uint i = 0u; i < 4u; ++i) {
    const uint place = (keys[i] > 0u ? counts[keys[i] - 1u] : 0u) + among[i];
    scratch_order[region * kRegionRays + place].bits = keys[i] == kNoRayKey ? kNoRay : i * kRayKeys + thread;
  }
}
