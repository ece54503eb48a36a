// Brute-force direct light: a shadow ray to EVERY punctual light, and stratified rays to every emissive triangle. Shares with the
// reservoirs only the BSDF, the punctual lights' formula, the environment's table and the rays; nothing here weighs or reuses.
#include "random.glsl"
#include "bsdf.glsl"
#include "visibility.glsl"
#include "spherical_triangle.glsl"

vec3 arriving(Surface surface, LightSample light) {
  if (light.radiance == vec3(0.0)) return vec3(0.0);
  const vec3 f = bsdfCos(surface, light.direction) * light.radiance;
  if (f == vec3(0.0)) return vec3(0.0);
  return f * traceVisibility(surface, light);
}

// A stratified sample of a triangle that looks large from the surface, uniform in solid angle: its estimate is bounded, whereas
// uniform area sampling has unbounded variance close to the light. `area` is the solid angle.
LightSample sampleBySolidAngle(Light light, SphericalTriangle t, vec2 u, vec3 position) {
  LightSample s;
  s.direction = sampleSphericalTriangle(t, u);
  s.area = t.solidAngle;
  const vec3 normal = cross(light.a, light.b);
  const float facing = -dot(normal, s.direction);
  const bool lit = facing > 0.0 || ((light.kind & kLightDoubleSided) != 0u && facing < 0.0);
  s.target = position + s.direction * (dot(normal, light.position - position) / dot(normal, s.direction));
  s.radiance = lit ? light.radiance : vec3(0.0);
#ifdef SCENE_TEXTURED_LIGHTS
  if (lit && (light.kind & kLightTextured) != 0u) {
    s.radiance *= emissionTexture(light.triangle, clamp(barycentricsAlong(light, position, s.direction), 0.0, 1.0));
  }
#endif
  return s;
}

// A stratified sample uniform in area, for triangles that look small: there it is as good and more exact.
LightSample sampleByArea(Light light, vec2 u, vec3 position) {
  const float root = sqrt(u.x);
  return evaluateTriangle(light, vec2(root * (1.0 - u.y), root * u.y), position);
}

#ifdef SCENE_ENVIRONMENT
const int kByImportance = 0, kUniform = 1;

// n² directions, stratified over the sphere or over the cells of the table.
vec3 arrivingFromEnvironment(Surface surface, int n, inout Random random) {
  const uint strata = uint(n * n);
  vec3 sum = vec3(0.0);
  for (uint j = 0u; j < strata; ++j) {
    uvec4 bits = nextBits4(random);
    LightSample s;
    float spread = 4.0 * kPi;
    if (param_environment == kUniform) {
      const vec2 u = (vec2(j % uint(n), j / uint(n)) + vec2(uniformFloat(bits.x), uniformFloat(bits.y))) / float(n);
      const float y = 1.0 - 2.0 * u.y, across = 2.0 * sqrt(u.y * (1.0 - u.y)), longitude = 2.0 * kPi * u.x;
      const vec3 direction = vec3(across * cos(longitude), y, across * sin(longitude));
      s = environmentSample(direction, environmentRadiance(direction), surface.position);
    } else {
      const uint width = 0xffffffffu / strata;
      bits.x = j * width + scaleBits(bits.x, width);
      const uint place = pickEnvironment(bits, spread);
      s = evaluateEnvironment(place, surface.position);
    }
    sum += arriving(surface, s) * spread;
  }
  return sum / float(strata);
}
#endif

void run(uvec2 pixel) {
  const uint index = pixel.y * frameWidth + pixel.x;
  vec3 color = imageLoad(in_emission, ivec2(pixel)).rgb;
  const PackedSurface packed = in_surface[index];
  if (isSurface(packed)) {
    const Surface surface = unpackSurface(packed, pixel, camera, frameSize);
    Random random = randomFor(pixel, 0u);
    const int n = param_samples;  // a side of the stratified square on each triangle
    for (uint i = 0u; i < lightCount(); ++i) {
      const Light light = sceneLights[i];
#ifdef SCENE_ENVIRONMENT
      if ((light.kind & kKindMask) == kEnvironment) {
        color += arrivingFromEnvironment(surface, n, random);
        continue;
      }
#endif
      if ((light.kind & kKindMask) != kTriangle) {
        color += arriving(surface, evaluatePunctual(light, surface.position));
        continue;
      }
      const SphericalTriangle t = sphericalTriangle(light.position - surface.position, light.a, light.b);
      const bool large = t.solidAngle > kLeastSolidAngle;
      vec3 sum = vec3(0.0);
      for (int j = 0; j < n * n; ++j) {
        const vec2 u = (vec2(j % n, j / n) + next2(random)) / float(n);
        LightSample s;
        if (large) s = sampleBySolidAngle(light, t, u, surface.position);
        else s = sampleByArea(light, u, surface.position);
        sum += arriving(surface, s) * s.area;
      }
      color += sum / float(n * n);
    }
  }
  imageStore(out_color, ivec2(pixel), vec4(color, 1.0));
}
