// Spatial reuse: each pixel's reservoirs are merged with those of pixels around it whose surfaces are alike.
// Bitterli et al. 2020, section 4. One launch an iteration; launchIndex is its number.
#include "mutants.glsl"
#include "random.glsl"
#include "merge.glsl"

const uint kPerPixel = in_reservoirs_count;
const uint kMostNeighbours = 16u;

uint neighbours[kMostNeighbours];  // indices of pixels
uint found = 0u;
uint which = 0u;  // of a pixel's samples
Random random;

uint neighbourCount() { return found; }
#ifdef WEIR_MUTANT
Surface centre;
#endif
Reservoir neighbourReservoir(uint i) {
  Reservoir r = in_reservoirs[neighbours[i] * kPerPixel + which];
  if (MUTANT(12, isNull(r), false)) r.confidence = 0.0;
#ifdef WEIR_MUTANT
  if (WEIR_MUTANT == 13 && !isNull(r) &&
      targetFunction(centre, evaluateLight(lightOf(r), r.place, centre.position)) <= 0.0) r.confidence = 0.0;
#endif
  return r;
}
Surface neighbourSurface(uint i) {
  const uint n = neighbours[i];
  Surface s = unpackSurface(in_surface[n], uvec2(n % frameWidth, n / frameWidth), camera, frameSize);
#ifdef WEIR_MUTANT
  s.position = MUTANT(10, centre.position, s.position);
#endif
  return s;
}
bool isThisSurface(uint i) { return false; }
float nextChance() { return next1(random); }

// Who takes part follows from the surfaces alone.
void findNeighbours(uvec2 pixel, PackedSurface packed) {
  const float cosine = cos(radians(param_normalThreshold));
  for (int i = 0; i < param_neighbours; ++i) {
    const vec2 u = next2(random);
    const float angle = 2.0 * kPi * u.y;
    const vec2 offset = param_radius * sqrt(u.x) * vec2(cos(angle), sin(angle));
    const ivec2 other = ivec2(floor(vec2(pixel) + 0.5 + offset));
    if (any(lessThan(other, ivec2(0))) || any(greaterThanEqual(other, ivec2(frameSize))) || other == ivec2(pixel)) continue;
    const uint otherIndex = uint(other.y) * frameWidth + uint(other.x);
    const PackedSurface candidate = in_surface[otherIndex];
    if (!isSurface(candidate)) continue;
    if (!similar(packed, candidate, param_depthThreshold, cosine, param_albedoThreshold)) continue;
    neighbours[found++] = otherIndex;
  }
}

void run(uvec2 pixel) {
  const uint index = pixel.y * frameWidth + pixel.x;
  const PackedSurface packed = in_surface[index];
  if (!isSurface(packed)) {
    for (uint k = 0u; k < kPerPixel; ++k) out_reservoirs[index * kPerPixel + k] = emptyReservoir();
#ifdef wanted_out_light
    if (launchIndex + 1u == uint(param_iterations)) imageStore(out_light, ivec2(pixel), vec4(0.0));
#endif
    return;
  }
  const Surface surface = unpackSurface(packed, pixel, camera, frameSize);
  random = randomFor(pixel, launchIndex);
#ifdef WEIR_MUTANT
  centre = surface;
#endif
  findNeighbours(pixel, packed);
  vec3 light = vec3(0.0);
  for (which = 0u; which < kPerPixel; ++which) {
    const uint at = index * kPerPixel + which;
    mergedLight = vec3(0.0);
    out_reservoirs[at] = merge(surface, in_reservoirs[at]);
    light += mergedLight;
  }
#ifdef wanted_out_light
  if (launchIndex + 1u == uint(param_iterations)) imageStore(out_light, ivec2(pixel), vec4(light / float(kPerPixel), 1.0));
#endif
}
