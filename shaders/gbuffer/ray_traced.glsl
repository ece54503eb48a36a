// First visible surfaces by one ray a pixel.
#include "trace.glsl"
#include "gbuffer_common.glsl"

void run(uvec2 pixel) {
  const uvec2 jitter = frameJitter();
  const vec3 direction = cameraDirection(camera, vec2(pixel) + jitterPlace(jitter), frameSize);
  const Hit hit = traceClosest(camera.origin.xyz, direction, kInfinity, coverageKey(pixel), kCameraSides);
  writePixel(pixel, hit, direction, jitter);
}
