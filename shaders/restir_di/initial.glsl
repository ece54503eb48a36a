// Initial candidates by streaming RIS (Talbot et al. 2005; Bitterli et al. 2020, algorithm 3): M lights picked by power, one kept in
// proportion to p̂/p. Several reservoirs of a pixel share the candidates and choose from them independently.
#include "random.glsl"
#include "reservoir.glsl"
#include "spherical_triangle.glsl"

const int kByArea = 0, kBySolidAngle = 1;

// A point on a light, drawn for a surface.
struct Candidate {
  LightSample light;
  uint place;
  float spread;  // 1 / density of the point: per m² on triangles, 1 for punctual lights
};

Candidate drawCandidate(Light light, vec2 u, vec3 position) {
  Candidate c;
  c.place = packPlace(u);
  if (param_triangles == kBySolidAngle && (light.kind & kKindMask) == kTriangle) {
    const SphericalTriangle t = sphericalTriangle(light.position - position, light.a, light.b);
    if (t.near) {
      // Seen edge on it has no solid angle, and whatever place stands here counts for nothing.
      if (t.solidAngle > 0.0) c.place = placeAt(barycentricsAlong(light, position, sampleSphericalTriangle(t, u)));
      c.light = evaluateLight(light, c.place, position);
      // dω = cos θ / d² dA turns the uniform density 1/Ω into one per m², at the very point that the 16 bits name.
      const vec3 d = c.light.target - position;
      const float cosine = abs(dot(cross(light.a, light.b), c.light.direction)) / (2.0 * light.area);
      c.spread = cosine > 0.0 ? t.solidAngle * dot(d, d) / cosine : 0.0;
      return c;
    }
  }
  c.light = evaluateLight(light, c.place, position);
  c.spread = c.light.area;
  return c;
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
      const vec4 u = next4(random);
      const uint chosen = pickMixed(u.x, u.y, param_uniformShare);
      const Light light = sceneLights[chosen];
      const Candidate c = drawCandidate(light, u.zw, surface.position);
      const float target = targetFunction(surface, c.light);
      if (!(target > 0.0)) continue;
      // 1/M · p̂ / p, with p = pdf of the light times density on it.
      const float weight = target * c.spread / (mixedPdf(light, param_uniformShare) * float(param_candidates));
      const vec4 keep = next4(random);
      for (uint k = 0u; k < out_reservoirs_count; ++k) {
        offer(selections[k], chosen, c.place, target, weight, false, keep[k]);
      }
    }
  }
  for (uint k = 0u; k < out_reservoirs_count; ++k) {
    Reservoir r = lit ? finish(selections[k], 1.0) : emptyReservoir();
#ifdef CAN_TRACE
    if (param_visibility && lit) testVisibility(r, surface);
#endif
    out_reservoirs[index * out_reservoirs_count + k] = r;
  }
}
