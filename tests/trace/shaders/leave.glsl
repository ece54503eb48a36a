// Shadow rays as estimators shoot them. sky: to points far outside over the geometric hemisphere, grazing ones too, which a convex
// scene leaves free. lights: to points on the scene's lights, free too. leak: to points outside of a closed room, never free.
#include "random.glsl"
#include "visibility.glsl"
#include "hit_surface.glsl"

void run(uvec2 pixel) {
  const uint index = pixel.y * frameWidth + pixel.x;
  const PackedSurface packed = in_surface[index];
  if (!isSurface(packed)) {
    out_count[index] = Count(0u, 0u);
    return;
  }
  Surface s = unpackSurface(packed, pixel, camera, frameSize);
  if (param_traced) {
    const vec3 direction = -s.view;
    const Hit hit = traceClosest(camera.origin.xyz, direction, 3.0e38, 0u, kCameraSides);
    if (hit.triangle == kNoTriangle) {
      out_count[index] = Count(0u, 0u);
      return;
    }
    s = surfaceFrom(surfaceAt(hit, camera.origin.xyz, direction, kBaseTexels), direction);
  }
  const vec3 side = normalize(abs(s.geometricNormal.x) < 0.5 ? cross(s.geometricNormal, vec3(1, 0, 0))
                                                             : cross(s.geometricNormal, vec3(0, 1, 0)));
  const vec3 other = cross(s.geometricNormal, side);
  Random random = randomFor(pixel, 0u);
  uint wrong = 0u, all = 0u;
  for (int i = 0; i < param_rays; ++i) {
    const vec4 u = next4(random);
    LightSample light;
    if (param_mode == 1) {
      light = evaluateLight(min(uint(u.x * float(lightCount())), lightCount() - 1u), packPlace(u.yz), s.position);
      if (dot(light.direction, s.geometricNormal) <= 0.0 || light.radiance == vec3(0.0)) continue;
    } else {
      // The packed normal is off by up to 1e-4: a ray closer to the horizon may rightly enter the surface.
      const float cosine = max(u.x * u.x, 3e-4), sine = sqrt(1.0 - cosine * cosine), phi = 6.2831853 * u.y;
      light.direction = side * (sine * cos(phi)) + other * (sine * sin(phi)) + s.geometricNormal * cosine;
      light.target = s.position + light.direction * (sceneDiameter * (0.001 + u.z * u.z));
      // A target within the position's own error of the surface may lie below it: nobody could call it free.
      if (cosine * length(light.target - s.position) < 4.0 * s.error) continue;
      if (param_mode == 2) light.target = s.position + light.direction * (sceneDiameter * 2.0);
    }
    const float through = traceVisibility(s, light);
    ++all;
    if (param_mode == 2 ? through > 0.0 : through < 1.0) ++wrong;
  }
  out_count[index] = Count(wrong, all);
}
