// Temporal reuse: each pixel's reservoirs are merged with those that its surface had last frame, found by the motion vector.
// Bitterli et al. 2020, section 4; the history counts at most `confidenceCap` fresh frames. The history's target is that of LAST
// frame's surface, camera, lights and geometry.
#define PREVIOUS_DOMAIN 1
#include "mutants.glsl"
#include "random.glsl"
#include "merge.glsl"

const uint kPerPixel = in_reservoirs_count;

// The one neighbour: the surface of last frame's pixel, with its history.
Surface beforeSurface;
Reservoir history;
vec4 chances;

uint neighbourCount() { return 1u; }
Reservoir neighbourReservoir(uint i) { return history; }
Surface neighbourSurface(uint i) { return beforeSurface; }
bool stays = false;
bool isThisSurface(uint i) { return stays; }
float nextChance() {
  chances = chances.yzwx;
  return chances.w;
}

void run(uvec2 pixel) {
  const uint index = pixel.y * frameWidth + pixel.x;
  const PackedSurface packed = in_surface[index];
  if (!isSurface(packed)) {
    for (uint k = 0u; k < kPerPixel; ++k) out_reservoirs[index * kPerPixel + k] = emptyReservoir();
    return;
  }
  const Surface surface = unpackSurface(packed, pixel, camera, frameSize);

  // The pixel that holds the point where this surface was.
  const vec2 motion = imageLoad(in_motion, ivec2(pixel)).xy;
  const vec2 point = vec2(pixel) + unpackJitter(packed.roughnessJitter) + motion;
  // Asked before it is made an integer: what becomes of infinity (behind the old camera) and NaN then is not defined.
  bool reuse = all(greaterThanEqual(point, vec2(0.0))) && all(lessThan(point, frameSize));
  const ivec2 before = reuse ? ivec2(point) : ivec2(0);
  const uint beforeIndex = reuse ? uint(before.y) * frameWidth + uint(before.x) : 0u;
  const PackedSurface beforePacked = in_previousSurface[beforeIndex];
  if (reuse) {
    // Compare at the distance from which last frame's camera should have seen this point.
    PackedSurface expected = packed;
    expected.distance = distance(surface.position, previousCamera.origin.xyz);
    reuse = isSurface(beforePacked) &&
            similar(expected, beforePacked, param_depthThreshold, cos(radians(param_normalThreshold)), param_albedoThreshold);
  }
  if (!reuse) {
    for (uint k = 0u; k < kPerPixel; ++k) out_reservoirs[index * kPerPixel + k] = in_reservoirs[index * kPerPixel + k];
    return;
  }
#ifndef SCENE_ANIMATED
  // Nothing moved, neither here nor between here and any light.
  stays = uvec2(before) == pixel && camera == previousCamera && packed.distance == beforePacked.distance &&
          packed.geometricNormal == beforePacked.geometricNormal &&
          (packed.roughnessJitter & 0xffffu) == (beforePacked.roughnessJitter & 0xffffu);
#endif
  beforeSurface = unpackSurface(beforePacked, uvec2(before), MUTANT(14, camera, previousCamera), frameSize);
  Random random = randomFor(pixel, 0u);
  for (uint k = 0u; k < kPerPixel; ++k) {
    const Reservoir own = in_reservoirs[index * kPerPixel + k];
    history = sanitized(in_history[beforeIndex * kPerPixel + k]);
    if (MUTANT(15, isNull(history), false)) history.confidence = 0.0;
    history.confidence = min(history.confidence, float(param_confidenceCap) * own.confidence);
    chances = MUTANT(16, vec4(0.5), next4(random));
    out_reservoirs[index * kPerPixel + k] = merge(surface, own);
  }
}
