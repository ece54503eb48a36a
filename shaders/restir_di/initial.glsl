// Initial candidates by streaming RIS (Talbot et al. 2005; Bitterli et al. 2020, algorithm 3): M lights picked by power, one kept in
// proportion to p̂/p. The environment is also found by directions that the BSDF prefers, points on triangles along its specular lobe,
// and both by rays along the BSDF. Several reservoirs of a pixel share the candidates and choose from them independently.
#include "initial_weights.glsl"

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
    weight = environmentWeight(surface, mixedPdf(environment, param_uniformShare), at, environmentDensity(place), target);
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
    for (int i = 0; i < param_candidates; ++i) {
      uvec4 bits = nextBits4(random);
      // One pick in each part of the table: together they have its distribution, with less chance in how often a light comes.
      bits.x = stratumBits(bits.x, uint(i), uint(param_candidates));
      const uint chosen = pickMixed(bits.xy, param_uniformShare);
      const Light light = sceneLights[chosen];
      const Candidate c = drawCandidate(light, bits.zw, surface, random);
      const float target = targetFunction(surface, c.light);
      if (!(target > 0.0)) continue;
      // 1/M · p̂ / p, with p = pdf of the light times density on it.
      float weight = target * c.spread / (mixedPdf(light, param_uniformShare) * float(MUTANT(30, param_candidates + 1, param_candidates)));
#ifdef BSDF_RAYS
      if ((light.kind & kKindMask) == kTriangle) weight = triangleWeight(surface, light, c.light, 1.0 / c.spread, target);
#endif
#ifdef SCENE_ENVIRONMENT
      if ((light.kind & kKindMask) == kEnvironment) {
        weight = environmentWeight(surface, mixedPdf(light, param_uniformShare), c.light, 1.0 / c.spread, target);
      }
#endif
      offerAll(selections, chosen, c.place, target, weight, false, random);
    }
#ifdef SCENE_ENVIRONMENT
    lookAlongBsdf(selections, surface, mixedPdf(sceneLights[lightCount() - 1u], param_uniformShare), random);
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
