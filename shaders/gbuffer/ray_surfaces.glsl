// From what the camera's rays met to surfaces.
#include "gbuffer_common.glsl"

void run(uvec2 pixel) {
  const uvec2 jitter = frameJitter();
  const vec3 direction = cameraDirection(camera, vec2(pixel) + jitterPlace(jitter), frameSize);
  const RayHit hit = scratch_hits[pixel.y * frameWidth + pixel.x];
  writePixel(pixel, Hit(hit.triangle, hit.instance, hit.barycentrics), direction, jitter);
}
