// Initial candidates by streaming RIS (Talbot et al. 2005; Bitterli et al. 2020, algorithm 3): M lights picked by power, one kept in
// proportion to p̂/p. The environment is also found by directions that the BSDF prefers, points on triangles along its specular lobe.
// Several reservoirs of a pixel share the candidates and choose from them independently.
#include "random.glsl"
#include "reservoir.glsl"
#include "light_sample.glsl"

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
  const vec2 u = vec2(uniformFloat(bits.x), uniformFloat(bits.y));
  if ((light.kind & kKindMask) == kTriangle) return drawOnTriangle(light, u, surface, triangleWays());
  c.place = packPlace(u);
  c.light = evaluateLight(light, c.place, surface.position);
  c.spread = c.light.area;
  return c;
}

#ifdef SCENE_ENVIRONMENT
// Both ways to a direction of the environment give it the weight p̂ over the sum of their expected numbers there: the balance heuristic
// over all candidates of the pixel (Veach 1997; Talbot et al. 2005).
float environmentWeight(Surface surface, Light environment, LightSample light, float density, float target) {
  return target / (float(param_candidates) * mixedPdf(environment, param_uniformShare) * density +
                   float(param_bsdfCandidates) * bsdfDensity(surface, light.direction));
}
#endif

void offerAll(inout Selection selections[out_reservoirs_count], uint light, uint place, float target, float weight,
              inout Random random) {
  const vec4 keep = next4(random);
  for (uint k = 0u; k < out_reservoirs_count; ++k) offer(selections[k], light, place, target, weight, false, keep[k]);
}

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
      const uvec4 bits = nextBits4(random);
      const uint chosen = pickMixed(bits.xy, param_uniformShare);
      const Light light = sceneLights[chosen];
      const Candidate c = drawCandidate(light, bits.zw, surface, random);
      const float target = targetFunction(surface, c.light);
      if (!(target > 0.0)) continue;
      // 1/M · p̂ / p, with p = pdf of the light times density on it.
      float weight = target * c.spread / (mixedPdf(light, param_uniformShare) * float(param_candidates));
#ifdef SCENE_ENVIRONMENT
      if ((light.kind & kKindMask) == kEnvironment) {
        weight = environmentWeight(surface, light, c.light, 1.0 / c.spread, target);
      }
#endif
      offerAll(selections, chosen, c.place, target, weight, random);
    }
#ifdef SCENE_ENVIRONMENT
    const uint last = lightCount() - 1u;  // where the environment is
    const Light environment = sceneLights[last];
    for (int i = 0; i < param_bsdfCandidates && (environment.kind & kKindMask) == kEnvironment; ++i) {
      const uint place = environmentPlace(sampleBsdf(surface, next4(random).xyz));
      const LightSample light = evaluateEnvironment(place, surface.position);
      const float target = targetFunction(surface, light);
      if (!(target > 0.0)) continue;
      offerAll(selections, last, place, target,
               environmentWeight(surface, environment, light, environmentDensity(place), target), random);
    }
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
