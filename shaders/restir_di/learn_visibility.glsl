// What shadow rays of this frame found, added to what is remembered of the frames before, tile by tile: one workgroup each.
#include "reservoir_state.glsl"
#include "visibility_cache.glsl"

const uint kCells = out_visibility_count;

shared uint looked[kCells];  // times looked above 16 bits, times seen below

// Light comes through: it was tested and is there.
void note(Reservoir r) {
  if (!isNull(r)) atomicAdd(looked[cacheCell(lightOf(r), uint(sceneLightCount), kCells)], 0x10001u);
  else if (isHidden(r)) atomicAdd(looked[cacheCell(lightOf(r), uint(sceneLightCount), kCells)], 0x10000u);
}

void run(uvec2 pixel) {
  const uint thread = gl_LocalInvocationIndex, threads = gl_WorkGroupSize.x * gl_WorkGroupSize.y;
  const uint index = pixel.y * frameWidth + pixel.x;
  const uint tile = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  for (uint cell = thread; cell < kCells; cell += threads) looked[cell] = 0u;
  barrier();
  if (all(lessThan(pixel, launchSize))) {
    for (uint k = 0u; k < in_tested_count; ++k) note(in_tested[index * in_tested_count + k]);
#ifdef has_in_more
    for (uint k = 0u; k < in_more_count; ++k) note(in_more[index * in_more_count + k]);
#endif
  }
  barrier();
  for (uint cell = thread; cell < kCells; cell += threads) {
    const uint at = tile * kCells + cell;
    vec2 counts = cachedCounts(in_history[at]) * (1.0 - 1.0 / param_frames);
    counts += vec2(looked[cell] & 0xffffu, looked[cell] >> 16u);
    if (counts.y > 500.0) counts *= 500.0 / counts.y;
    // One look more that saw it: what nobody looked for is likely there.
    const float guess = max((counts.x + 1.0) / (counts.y + 1.0), param_least);
    out_visibility[at] = cacheCellOf(counts, guess);
  }
}
