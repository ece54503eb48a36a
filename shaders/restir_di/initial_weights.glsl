// What candidates weigh: p̂ over the sum of the expected numbers, at this point, of all ways to it: the balance heuristic over all
// candidates of the pixel (Veach 1997; Talbot et al. 2005). For the environment per steradian, for triangles per m².
#ifndef WEIR_INITIAL_WEIGHTS
#define WEIR_INITIAL_WEIGHTS

#include "mutants.glsl"
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
#ifdef SCENE_TRIANGLE_LIGHTS
  const vec2 u = vec2(uniformFloat(bits.x), uniformFloat(bits.y));
  if ((light.kind & kKindMask) == kTriangle) return drawOnTriangle(light, u, surface, triangleWays());
#endif
  c.place = 0u;
  c.light = evaluatePunctual(light, surface.position);
  c.spread = c.light.area;
  return c;
}

#ifdef BSDF_RAYS
float triangleWeight(Surface surface, Light light, LightSample at, float density, float target) {
  return target / (float(param_candidates) * mixedPdf(light, param_uniformShare) * density +
                   float(param_bsdfRays) * bsdfDensity(surface, at.direction) * MUTANT(32, 1.0, steradianPerArea(light, at, surface.position)));
}
#endif

#ifdef SCENE_ENVIRONMENT
// `pick`: probability of picking the environment among all lights.
float environmentWeight(Surface surface, float pick, LightSample light, float density, float target) {
#ifdef BSDF_RAYS
  const float byBsdf = float(param_bsdfCandidates + param_bsdfRays);
#else
  const float byBsdf = float(param_bsdfCandidates);
#endif
  return target / (float(param_candidates) * pick * density +
                   MUTANT(31, 0.0, byBsdf) * bsdfDensity(surface, light.direction));
}
#endif

void offerAll(inout Selection selections[out_reservoirs_count], uint light, uint place, float target, float weight, bool seen,
              inout Random random) {
  const vec4 keep = next4(random);
  for (uint k = 0u; k < out_reservoirs_count; ++k) offer(selections[k], light, place, target, weight, seen, keep[k]);
}

#ifdef SCENE_ENVIRONMENT
// Directions of the environment by the BSDF.
void lookAlongBsdf(inout Selection selections[out_reservoirs_count], Surface surface, float pick, inout Random random) {
  const uint last = lightCount() - 1u;  // where the environment is
  const Light environment = sceneLights[last];
  for (int i = 0; i < param_bsdfCandidates && (environment.kind & kKindMask) == kEnvironment; ++i) {
    const uint place = environmentPlace(sampleBsdf(surface, next4(random).xyz));
    const LightSample light = evaluateEnvironment(place, surface.position);
    const float target = targetFunction(surface, light);
    if (!(target > 0.0)) continue;
    offerAll(selections, last, place, target, environmentWeight(surface, pick, light, environmentDensity(place), target), false,
             random);
  }
}
#endif

#endif
