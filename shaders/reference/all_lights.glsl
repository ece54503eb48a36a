// Brute-force direct light: a shadow ray to EVERY punctual light, and stratified rays to every emissive triangle. Shares with the
// reservoirs only the BSDF, the punctual lights' formula and the rays; nothing here picks, weighs or reuses.
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
  s.radiance = lit ? light.radiance : vec3(0.0);
#ifdef SCENE_TEXTURED_LIGHTS
  if (lit && (light.kind & kLightTextured) != 0u) {
    s.radiance *= lightTexture(light, clamp(barycentricsAlong(light, position, s.direction), 0.0, 1.0));
  }
#endif
  return s;
}

// A stratified sample uniform in area, for triangles that are far for their size: there it is as good and more exact.
LightSample sampleByArea(Light light, vec2 u, vec3 position) {
  const float root = sqrt(u.x);
  return evaluateTriangle(light, vec2(root * (1.0 - u.y), root * u.y), position);
}

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
      if ((light.kind & kKindMask) != kTriangle) {
        color += arriving(surface, evaluatePunctual(light, surface.position));
        continue;
      }
      const SphericalTriangle t = sphericalTriangle(light.position - surface.position, light.a, light.b);
      if (!(t.solidAngle > 0.0)) continue;
      vec3 sum = vec3(0.0);
      for (int j = 0; j < n * n; ++j) {
        const vec2 u = (vec2(j % n, j / n) + next2(random)) / float(n);
        LightSample s;
        if (t.near) s = sampleBySolidAngle(light, t, u, surface.position);
        else s = sampleByArea(light, u, surface.position);
        sum += arriving(surface, s) * s.area;
      }
      color += sum / float(n * n);
    }
  }
  imageStore(out_color, ivec2(pixel), vec4(color, 1.0));
}
