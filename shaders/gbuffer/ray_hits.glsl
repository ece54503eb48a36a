// One ray a pixel, and what it met; ray_surfaces.glsl turns that into surfaces. Apart, since rays want many invocations in flight and
// whatever reads textures wants registers.
#include "trace.glsl"
#include "camera.glsl"
#include "gbuffer_jitter.glsl"

void run(uvec2 pixel) {
  const uvec2 jitter = frameJitter();
  const vec3 direction = cameraDirection(camera, vec2(pixel) + jitterPlace(jitter), frameSize);
  const Hit hit = traceClosest(camera.origin.xyz, direction, 3.0e38, coverageKey(pixel), kCameraSides);
  scratch_hits[pixel.y * frameWidth + pixel.x] = RayHit(hit.triangle, hit.instance, hit.barycentrics);
}
