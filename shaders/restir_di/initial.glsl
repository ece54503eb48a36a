// Initial candidates by streaming RIS (Talbot et al. 2005; Bitterli et al. 2020, algorithm 3): M lights picked by power, one kept in
// proportion to p̂/p. The environment is also found by directions that the BSDF prefers, points on triangles along its specular lobe,
// and both by rays along the BSDF. With tiles the lights are picked beforehand (tiles.glsl). Several reservoirs of a pixel share the
// candidates and choose from them independently.
#include "mutants.glsl"
#include "random.glsl"
#include "reservoir.glsl"
#include "light_sample.glsl"

#ifdef TILE_SIZE
#include "tiles.glsl"
#endif

const int kByArea = 0, kBySolidAngle = 1;

TriangleWays triangleWays() { return TriangleWays(param_triangles == kBySolidAngle, param_lobeShare); }

Candidate drawCandidate(Light light, uvec2 bits, Surface surface, inout Random random) {
  Candidate c;
#ifdef SCENE_ENVIRONMENT
  if ((light.kind & kKindMask) == kEnvironment) {
    c.place = pickEnvironment(nextBits4(random), c.spread);
    c.light = evaluateEnvironment(c.place, surface.position);
    return c;
  }
#endif
#ifdef SCENE_TRIANGLE_LIGHTS
  const vec2 u = vec2(uniformFloat(bits.x), uniformFloat(bits.y));
  if ((light.kind & kKindMask) == kTriangle) return drawOnTriangle(light, u, surface, triangleWays());
#endif
  c.place = 0u;
  c.light = evaluatePunctual(light, surface.position);
  c.spread = c.light.area;
  return c;
}

// All ways to a point give it the weight p̂ over the sum of their expected numbers there: the balance heuristic over all candidates of the
// pixel (Veach 1997; Talbot et al. 2005). For the environment per steradian, for triangles per m².
#ifdef BSDF_RAYS
float triangleWeight(Surface surface, Light light, LightSample at, float density, float target) {
  return target / (float(param_candidates) * mixedPdf(light, param_uniformShare) * density +
                   float(param_bsdfRays) * bsdfDensity(surface, at.direction) * MUTANT(32, 1.0, steradianPerArea(light, at, surface.position)));
}
#endif

#ifdef SCENE_ENVIRONMENT
float environmentWeight(Surface surface, Light environment, LightSample light, float density, float target) {
#ifdef BSDF_RAYS
  const float byBsdf = float(param_bsdfCandidates + param_bsdfRays);
#else
  const float byBsdf = float(param_bsdfCandidates);
#endif
  return target / (float(param_candidates) * mixedPdf(environment, param_uniformShare) * density +
                   MUTANT(31, 0.0, byBsdf) * bsdfDensity(surface, light.direction));
}
#endif

void offerAll(inout Selection selections[out_reservoirs_count], uint light, uint place, float target, float weight, bool seen,
              inout Random random) {
  const vec4 keep = next4(random);
  for (uint k = 0u; k < out_reservoirs_count; ++k) offer(selections[k], light, place, target, weight, seen, keep[k]);
}

#ifdef BSDF_RAYS
// A ray along the BSDF. What it meets is a candidate if it is a light: an emissive triangle, or the environment where it meets nothing.
// Its density is that of the direction wherever the light is seen at all: a surface that blends is met, or lets the ray through, with a
// probability that belongs to this way alone, and is divided out.
void offerRay(inout Selection selections[out_reservoirs_count], Surface surface, inout Random random) {
  const uvec4 bits = nextBits4(random);
  const vec3 direction = sampleBsdf(surface, vec3(uniformFloat(bits.x), uniformFloat(bits.y), uniformFloat(bits.z)));
  if (!(dot(surface.normal, direction) > 0.0) || !(dot(surface.geometricNormal, direction) > 0.0)) return;
  const Hit hit = traceClosest(offsetOrigin(surface, direction), direction, 3.0e38, bits.w, kEverySide);
  uint chosen = kNoLight, place = 0u;
  LightSample at;
  float target = 0.0, weight = 0.0;
  if (hit.triangle != kNoTriangle) {
    chosen = lightOfTriangle(hit.triangle);
    if (chosen == kNoLight) return;
    const Light light = sceneLights[chosen];
    place = placeAt(turnedBarycentrics(light, hit.barycentrics));
    at = evaluateLight(light, place, surface.position);
    target = targetFunction(surface, at);
    if (!(target > 0.0)) return;
    const SphericalTriangle t = seenTriangle(light, surface, triangleWays());
    const float density = triangleDensity(light, at, t, surface, lobeShareOf(triangleWays(), surface));
    weight = MUTANT(33, target / (float(param_bsdfRays) * bsdfDensity(surface, at.direction) * steradianPerArea(light, at, surface.position)),
                    triangleWeight(surface, light, at, density, target)) / triangleCoverage(hit.triangle, hit.barycentrics);
  } else {
#ifdef SCENE_ENVIRONMENT
    chosen = lightCount() - 1u;
    const Light environment = sceneLights[chosen];
    if ((environment.kind & kKindMask) != kEnvironment) return;
    place = environmentPlace(direction);
    at = evaluateEnvironment(place, surface.position);
    target = targetFunction(surface, at);
    if (!(target > 0.0)) return;
    weight = environmentWeight(surface, environment, at, environmentDensity(place), target);
#else
    return;
#endif
  }
  bool seen = true;
#ifdef SCENE_BLEND
  const float through = traceVisibility(surface, at);
  if (!(through > 0.0)) return;
  weight /= through;
  seen = through >= 1.0;
#endif
  offerAll(selections, chosen, place, target, weight, seen, random);
}
#endif

void offerLight(inout Selection selections[out_reservoirs_count], uint chosen, Light light, uvec2 bits, Surface surface,
                inout Random random) {
  const Candidate c = drawCandidate(light, bits, surface, random);
  const float target = targetFunction(surface, c.light);
  if (!(target > 0.0)) return;
  // 1/M · p̂ / p, with p = pdf of the light times density on it.
  float weight = target * c.spread / (mixedPdf(light, param_uniformShare) * float(MUTANT(30, param_candidates + 1, param_candidates)));
#ifdef BSDF_RAYS
  if ((light.kind & kKindMask) == kTriangle) weight = triangleWeight(surface, light, c.light, 1.0 / c.spread, target);
#endif
#ifdef SCENE_ENVIRONMENT
  if ((light.kind & kKindMask) == kEnvironment) weight = environmentWeight(surface, light, c.light, 1.0 / c.spread, target);
#endif
#if !defined(SCENE_TRIANGLE_LIGHTS) && !defined(SCENE_ENVIRONMENT)
  // No place was drawn, which leaves these bits.
  if (out_reservoirs_count == 1u) {
    offer(selections[0], chosen, c.place, target, weight, false, uniformFloat(bits.x));
    return;
  }
#endif
  offerAll(selections, chosen, c.place, target, weight, false, random);
}

#ifdef TILE_SIZE
void drawFromTile(inout Selection selections[out_reservoirs_count], uvec2 pixel, Surface surface, inout Random random) {
  const TileReader reader = tileReader(pixel, uint(param_candidates));
  vec4 keep;  // one hash for four candidates, where there is one reservoir to keep them in
  for (int i = 0; i < param_candidates; ++i) {
    if (out_reservoirs_count > 1u || (i & 3) == 0) keep = next4(random);
    const uint entry = tileEntry(reader, uint(i));
    const TileSample tile = scratch_tiles[entry];
#ifdef TILE_LIGHTS
    if (tile.color == 0u) {
      const TileLight t = scratch_tileLights[entry];
      const Light light = Light(t.position, t.kind, t.radiance, t.pdf, t.a, t.triangle, t.b, t.area);
      offerLight(selections, scratch_tileIndices[entry].light, light, nextBits4(random).zw, surface, random);
      continue;
    }
#endif
    const vec3 way = tile.position - surface.position;
    const float d2 = dot(way, way);
    if (!(d2 > 0.0)) continue;
    LightSample light;
    const float inverse = inversesqrt(d2);
    light.direction = way * inverse;
    light.radiance = unpackColor(tile.color) * (inverse * inverse);
    const float share = targetFunction(surface, light);  // p̂ over the light's probability
    const float weight = share / float(param_candidates);
    for (uint k = 0u; k < out_reservoirs_count; ++k) {
      offer(selections[k], entry | kTileEntry, 0u, share, weight, false, keep.x);
      keep = keep.yzwx;
    }
  }
  for (uint k = 0u; k < out_reservoirs_count; ++k) {
    if ((selections[k].light & kTileEntry) == 0u) continue;
    selections[k].light = scratch_tileIndices[selections[k].light & ~kTileEntry].light;
    selections[k].target *= MUTANT(37, sceneLights[selections[k].light].pdf,
                                   mixedPdf(sceneLights[selections[k].light], param_uniformShare));
  }
}
#else
void drawFromTable(inout Selection selections[out_reservoirs_count], Surface surface, inout Random random) {
  for (int i = 0; i < param_candidates; ++i) {
    uvec4 bits = nextBits4(random);
    // One pick in each part of the table: together they have its distribution, with less chance in how often a light comes.
    bits.x = stratumBits(bits.x, uint(i), uint(param_candidates));
    const uint chosen = pickMixed(bits.xy, param_uniformShare);
    offerLight(selections, chosen, sceneLights[chosen], bits.zw, surface, random);
  }
}
#endif

void run(uvec2 pixel) {
  const uint index = pixel.y * frameWidth + pixel.x;
  const PackedSurface packed = in_surface[index];
  Selection selections[out_reservoirs_count];
  for (uint k = 0u; k < out_reservoirs_count; ++k) selections[k] = noSelection();

  const bool lit = isSurface(packed) && lightCount() > 0u;
  Surface surface;
  if (lit) {
    surface = unpackSurface(packed, pixel, camera, frameSize);
    Random random = randomFor(pixel, 0u);
#ifdef TILE_SIZE
    drawFromTile(selections, pixel, surface, random);
#else
    drawFromTable(selections, surface, random);
#endif
#ifdef SCENE_ENVIRONMENT
    const uint last = lightCount() - 1u;  // where the environment is
    const Light environment = sceneLights[last];
    for (int i = 0; i < param_bsdfCandidates && (environment.kind & kKindMask) == kEnvironment; ++i) {
      const uint place = environmentPlace(sampleBsdf(surface, next4(random).xyz));
      const LightSample light = evaluateEnvironment(place, surface.position);
      const float target = targetFunction(surface, light);
      if (!(target > 0.0)) continue;
      offerAll(selections, last, place, target,
               environmentWeight(surface, environment, light, environmentDensity(place), target), false, random);
    }
#endif
#ifdef BSDF_RAYS
    for (int i = 0; i < param_bsdfRays; ++i) offerRay(selections, surface, random);
#endif
  }
  for (uint k = 0u; k < out_reservoirs_count; ++k) {
    Reservoir r = lit ? finish(selections[k], 1.0) : emptyReservoir();
#ifdef CAN_TRACE
    if (param_visibility && lit) testVisibility(r, surface);
#endif
    out_reservoirs[index * out_reservoirs_count + k] = r;
  }
}
