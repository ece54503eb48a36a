// How light samples are drawn for a surface, and with which density: a light by power and uniformly, then a point on it. Whoever finds a
// light by another way (a ray along the BSDF) weighs it with these densities: multiple importance sampling (Veach 1997).
#ifndef WEIR_LIGHT_SAMPLE
#define WEIR_LIGHT_SAMPLE

#include "mutants.glsl"
#include "bsdf_sample.glsl"
#include "lights.glsl"
#include "spherical_triangle.glsl"

// A point on a light, drawn for a surface.
struct Candidate {
  LightSample light;
  uint place;
  float spread;  // 1 / density of the point: m² on triangles, steradian on the environment, 1 for punctual lights; 0: counts for nothing
};

// Which ways to a point on a triangle are taken.
struct TriangleWays {
  bool bySolidAngle;  // where the triangle is close for its size; else by area
  float lobeShare;    // on glossy surfaces: share of the points that are looked for along the specular lobe
};

float lobeShareOf(TriangleWays ways, Surface surface) { return isGlossy(surface) ? ways.lobeShare : 0.0; }

SphericalTriangle seenTriangle(Light light, Surface surface, TriangleWays ways) {
  SphericalTriangle t;
  t.near = false;
  if (ways.bySolidAngle) t = sphericalTriangle(light.position - surface.position, light.a, light.b, surface.error);
  return t;
}

// Steradian for an m² of the light around a point of it: dω = cos θ / d² dA turns densities per steradian into ones per m².
float steradianPerArea(Light light, LightSample at, vec3 position) {
  const vec3 d = at.target - position;
  return abs(dot(cross(light.a, light.b), at.direction)) / (2.0 * light.area * dot(d, d));
}

// Density of the points that drawOnTriangle() draws, per m². Seen edge on a close triangle has no solid angle, and none are drawn.
float triangleDensity(Light light, LightSample at, SphericalTriangle t, Surface surface, float lobe) {
  if (t.near && !(t.solidAngle > 0.0)) return 0.0;
  if (lobe == 0.0 && !t.near) return 1.0 / light.area;
  const float perArea = steradianPerArea(light, at, surface.position);
  float density = MUTANT(52, 1.0, 1.0 - lobe) * (MUTANT(53, false, t.near) ? perArea / t.solidAngle : 1.0 / light.area);
  if (lobe > 0.0) density += MUTANT(51, 0.0, lobe) * specularDensity(surface, at.direction) * perArea;
  return density;
}

// A point on a triangle, drawn by area or by solid angle or along the specular lobe: a mixture whose density is that of all ways together.
Candidate drawOnTriangle(Light light, vec2 u, Surface surface, TriangleWays ways) {
  const vec3 position = surface.position;
  Candidate c;
  const float lobe = lobeShareOf(ways, surface);
  const SphericalTriangle t = seenTriangle(light, surface, ways);
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
  // Everything else is of the very point that the 16 bits name.
  c.light = evaluateTriangle(light, placeOnTriangle(c.place), position);
  if (!counts) c.light.radiance = vec3(0.0);
  if (lobe == 0.0 && !t.near) {
    c.spread = c.light.area;
    return c;
  }
  const float density = counts ? triangleDensity(light, c.light, t, surface, lobe) : 0.0;
  c.spread = density > 0.0 ? 1.0 / density : 0.0;
  return c;
}

// A point on any light; `bits` are uniform.
Candidate drawOnLight(Light light, uvec4 bits, Surface surface, TriangleWays ways) {
  const uint kind = light.kind & kKindMask;
  Candidate c;
#ifdef SCENE_ENVIRONMENT
  if (kind == kEnvironment) {
    c.place = pickEnvironment(bits, c.spread);
    c.light = evaluateEnvironment(c.place, surface.position);
    return c;
  }
#endif
  // The upper 24 bits: 1 must not be reached.
  const vec2 u = vec2(bits.xy >> 8u) * (1.0 / 16777216.0);
#ifdef SCENE_TRIANGLE_LIGHTS
  if (kind == kTriangle) return drawOnTriangle(light, u, surface, ways);
#endif
  c.place = packPlace(u);
  c.light = evaluatePunctual(light, surface.position);
  c.spread = c.light.area;
  return c;
}

// Density per steradian with which picking a light (pickMixed) and drawing a point on it finds the one that a ray from the surface met:
// 0 where that can't be found so.
float hitDensity(Light light, vec2 lightBarycentrics, Surface surface, TriangleWays ways, float uniformShare) {
  const LightSample at = evaluateTriangle(light, lightBarycentrics, surface.position);
  const float perArea = steradianPerArea(light, at, surface.position);
  if (!(perArea > 0.0)) return 0.0;
  const float density = triangleDensity(light, at, seenTriangle(light, surface, ways), surface, lobeShareOf(ways, surface));
  return mixedPdf(light, uniformShare) * density / MUTANT(62, 1.0, perArea);
}

#ifdef SCENE_ENVIRONMENT
// The same for a direction that met nothing: the environment is the last light of a scene that has one.
float missDensity(vec3 direction, float uniformShare) {
  if (lightCount() == 0u) return 0.0;
  const Light last = sceneLights[lightCount() - 1u];
  if ((last.kind & kKindMask) != kEnvironment) return 0.0;
  return MUTANT(66, last.pdf, mixedPdf(last, uniformShare)) * environmentDensity(environmentPlace(direction));
}
#endif

#endif
