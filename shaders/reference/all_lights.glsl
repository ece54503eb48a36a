// Brute-force direct light: a shadow ray to EVERY punctual light, and stratified rays to every emissive triangle. Shares with the
// reservoirs only the BSDF, the light's own formula and the rays; nothing here picks, weighs or reuses.
#include "random.glsl"
#include "bsdf.glsl"
#include "visibility.glsl"

vec3 arriving(Surface surface, LightSample light) {
  if (light.radiance == vec3(0.0)) return vec3(0.0);
  const vec3 f = bsdfCos(surface, light.direction) * light.radiance;
  if (f == vec3(0.0)) return vec3(0.0);
  return f * traceVisibility(surface, light);
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
      vec3 sum = vec3(0.0);
      for (int j = 0; j < n * n; ++j) {
        const vec2 u = (vec2(j % n, j / n) + next2(random)) / float(n);
        const float root = sqrt(u.x);
        sum += arriving(surface, evaluateTriangle(light, vec2(root * (1.0 - u.y), root * u.y), surface.position));
      }
      color += sum * (light.area / float(n * n));
    }
  }
  imageStore(out_color, ivec2(pixel), vec4(color, 1.0));
}
