// Brute-force direct light: a shadow ray to EVERY punctual light, and stratified rays to every emissive triangle. Shares with the
// reservoirs only the BSDF, the punctual lights' formula, the environment's table and the rays; nothing here weighs or reuses.
#include "random.glsl"
#include "bsdf.glsl"
#include "visibility.glsl"
#include "spherical_triangle.glsl"
#include "bsdf_sample.glsl"

vec3 arriving(Surface surface, LightSample light) {
  if (light.radiance == vec3(0.0)) return vec3(0.0);
  const vec3 f = bsdfCos(surface, light.direction) * light.radiance;
  if (f == vec3(0.0)) return vec3(0.0);
  return f * traceVisibility(surface, light);
}

// A stratified sample of a triangle close to the surface, uniform in solid angle: its estimate is bounded, whereas uniform area
// sampling has unbounded variance close to the light. `area` is the solid angle.
LightSample sampleBySolidAngle(Light light, SphericalTriangle t, vec2 u, vec3 position) {
  LightSample s;
  s.direction = sampleSphericalTriangle(t, u);
  s.area = t.solidAngle;
  const vec3 normal = cross(light.a, light.b);
  const float facing = -dot(normal, light.position - position);  // the same for every direction into the triangle
  const bool lit = facing > 0.0 || ((light.kind & kLightDoubleSided) != 0u && facing < 0.0);
  s.target = position + s.direction * (dot(normal, light.position - position) / dot(normal, s.direction));
  s.radiance = vec3(0.0);
  if (lit) s.radiance = emittedRadiance(light, clamp(barycentricsAlong(light, position, s.direction), 0.0, 1.0));
  return s;
}

// A stratified sample uniform in area, for triangles that are far for their size: there it is as good and more exact.
LightSample sampleByArea(Light light, vec2 u, vec3 position) {
  const float root = sqrt(u.x);
  return evaluateTriangle(light, vec2(root * (1.0 - u.y), root * u.y), position);
}

// On glossy surfaces stratum j of n² on the triangle or, beyond those, a direction along the specular lobe, weighted by the balance
// heuristic (Veach 1997): the lobe's peak would otherwise make the variance all but infinite.
LightSample sampleGlossy(Light light, SphericalTriangle t, Surface surface, bool alongLobe, vec2 u) {
  LightSample s;
  if (!alongLobe) {
    if (t.near) s = sampleBySolidAngle(light, t, u, surface.position);
    else s = sampleByArea(light, u, surface.position);
  } else {
    s.direction = sampleSpecular(surface, u);
    s.radiance = vec3(0.0);
    s.area = 0.0;
    vec2 barycentrics;
    if (!meetsTriangle(light, surface.position, s.direction, barycentrics)) return s;
    s = evaluateTriangle(light, barycentrics, surface.position);
  }
  const vec3 d = s.target - surface.position;
  const float perArea = abs(dot(cross(light.a, light.b), s.direction)) / (2.0 * light.area * dot(d, d));
  // Densities per steradian; what sampleBySolidAngle() gives is radiance per steradian, all else is per area.
  const float byTriangle = t.near ? 1.0 / t.solidAngle : 1.0 / (light.area * perArea);
  const float density = byTriangle + specularDensity(surface, s.direction);
  const float measured = t.near && !alongLobe ? density : density * perArea;
  s.area = measured > 0.0 ? 1.0 / measured : 0.0;
  return s;
}

#ifdef SCENE_ENVIRONMENT
const int kByImportance = 0, kUniform = 1;

LightSample environmentFrom(vec3 direction, vec3 position) {
  return environmentSample(direction, environmentRadiance(direction), position);
}

// Stratum j of n² on the sphere.
LightSample sampleUniformly(uint j, uint n, vec2 u, vec3 position) {
  u = (vec2(j % n, j / n) + u) / float(n);
  const float y = 1.0 - 2.0 * u.y, across = 2.0 * sqrt(u.y * (1.0 - u.y)), longitude = 2.0 * kPi * u.x;
  LightSample s = environmentFrom(vec3(across * cos(longitude), y, across * sin(longitude)), position);
  s.area = 4.0 * kPi;
  return s;
}

// Stratum j of n² of the table's cells or, beyond those, a direction by the BSDF; both with the reciprocal of the sum of the two
// densities as their area: the balance heuristic (Veach 1997).
LightSample sampleByImportance(Surface surface, uint j, uint strata, inout Random random) {
  LightSample s;
  float density;
  if (j < strata) {
    uvec4 bits = nextBits4(random);
    bits.x = stratumBits(bits.x, j, strata);
    float spread;
    s = evaluateEnvironment(pickEnvironment(bits, spread), surface.position);
    density = 1.0 / spread;
  } else {
    s = environmentFrom(sampleBsdf(surface, next4(random).xyz), surface.position);
    density = environmentDensity(environmentPlace(s.direction));
  }
  density += bsdfDensity(surface, s.direction);
  s.area = density > 0.0 ? 1.0 / density : 0.0;
  return s;
}
#endif

void run(uvec2 pixel) {
  const uint index = pixel.y * frameWidth + pixel.x;
  vec3 color = imageLoad(in_emission, ivec2(pixel)).rgb;
  const PackedSurface packed = in_surface[index];
  if (isSurface(packed)) {
    const Surface surface = unpackSurface(packed, pixel, camera, frameSize);
    Random random = randomFor(pixel, 0u);
    const bool glossy = isGlossy(surface);
    const uint n = uint(param_samples);  // a side of the stratified square on each triangle
    for (uint i = 0u; i < lightCount(); ++i) {
      const Light light = sceneLights[i];
      const uint kind = light.kind & kKindMask;
      SphericalTriangle t;
      uint samples = 1u, strata = 1u;
      if (kind == kTriangle) {
        t = sphericalTriangle(light.position - surface.position, light.a, light.b, surface.error);
        strata = n * n;
        samples = t.solidAngle > 0.0 ? (glossy ? 2u * strata : strata) : 0u;
      }
#ifdef SCENE_ENVIRONMENT
      if (kind == kEnvironment) {
        strata = n * n;
        samples = param_environment == kUniform ? strata : 2u * strata;
      }
#endif
      // One place that traces rays: compilers put a copy of all that belongs to it into each.
      vec3 sum = vec3(0.0);
      for (uint j = 0u; j < samples; ++j) {
        LightSample s;
        if (kind == kTriangle) {
          const uint stratum = j % strata;
          const vec2 u = (vec2(stratum % n, stratum / n) + next2(random)) / float(n);
          if (glossy) s = sampleGlossy(light, t, surface, j >= strata, u);
          else if (t.near) s = sampleBySolidAngle(light, t, u, surface.position);
          else s = sampleByArea(light, u, surface.position);
#ifdef SCENE_ENVIRONMENT
        } else if (kind == kEnvironment) {
          if (param_environment == kUniform) s = sampleUniformly(j, n, next2(random), surface.position);
          else s = sampleByImportance(surface, j, strata, random);
#endif
        } else {
          s = evaluatePunctual(light, surface.position);
        }
        sum += arriving(surface, s) * s.area;
      }
      color += sum / float(strata);
    }
  }
  imageStore(out_color, ivec2(pixel), vec4(color, 1.0));
}
