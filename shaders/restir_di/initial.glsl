// Initial candidates by streaming RIS (Talbot et al. 2005; Bitterli et al. 2020, algorithm 3): M lights picked by power, one kept in
// proportion to p̂/p. The environment is also found by directions that the BSDF prefers, points on triangles along its specular lobe.
// Several reservoirs of a pixel share the candidates and choose from them independently.
#include "random.glsl"
#include "reservoir.glsl"
#include "spherical_triangle.glsl"
#include "bsdf_sample.glsl"

const int kByArea = 0, kBySolidAngle = 1;

// A point on a light, drawn for a surface.
struct Candidate {
  LightSample light;
  uint place;
  float spread;  // 1 / density of the point: m² on triangles, steradian on the environment, 1 for punctual lights
};

// A point on a triangle, drawn by area or by solid angle or, on glossy surfaces with the probability lobeShare, along the specular
// lobe: a mixture whose density is that of all ways together.
Candidate drawOnTriangle(Light light, vec2 u, Surface surface) {
  const vec3 position = surface.position;
  Candidate c;
  c.spread = 0.0;
  const float lobe = isGlossy(surface) ? param_lobeShare : 0.0;
  SphericalTriangle t;
  t.near = false;
  if (param_triangles == kBySolidAngle) {
    t = sphericalTriangle(light.position - position, light.a, light.b, surface.error);
  }
  // Seen edge on it has no solid angle, and whatever place stands here counts for nothing.
  bool counts = !t.near || t.solidAngle > 0.0;
  if (u.x < lobe) {
    vec2 barycentrics;
    counts = counts && meetsTriangle(light, position, sampleSpecular(surface, vec2(u.x / lobe, u.y)), barycentrics);
    c.place = placeAt(barycentrics);
  } else {
    u.x = (u.x - lobe) / (1.0 - lobe);
    c.place = packPlace(u);
    if (t.near && counts) c.place = placeAt(barycentricsAlong(light, position, sampleSphericalTriangle(t, u)));
  }
  c.light = evaluateLight(light, c.place, position);
  if (!counts) c.light.radiance = vec3(0.0);
  if (lobe == 0.0 && !t.near) {
    c.spread = c.light.area;
    return c;
  }
  // dω = cos θ / d² dA turns densities per steradian into ones per m², at the very point that the 16 bits name.
  const vec3 d = c.light.target - position;
  const float perArea = abs(dot(cross(light.a, light.b), c.light.direction)) / (2.0 * light.area * dot(d, d));
  float density = (1.0 - lobe) * (t.near ? perArea / t.solidAngle : 1.0 / c.light.area);
  if (lobe > 0.0) density += lobe * specularDensity(surface, c.light.direction) * perArea;
  if (counts && density > 0.0) c.spread = 1.0 / density;
  return c;
}

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
  if ((light.kind & kKindMask) == kTriangle) return drawOnTriangle(light, u, surface);
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
