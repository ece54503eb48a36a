// A camera ray, as gbuffer.RayTraced shoots it through the pixel's centre.
#include "camera.glsl"
#include "random.glsl"
#include "trace.glsl"

void run(uvec2 pixel) {
  const vec3 direction = cameraDirection(camera, vec2(pixel) + 0.5, frameSize);
  const uint key = pcg4d(uvec4(pixel, frameIndex, frameSeed)).x;
  const Hit hit = traceClosest(camera.origin.xyz, direction, 3.0e38, key, kCameraSides);
  imageStore(out_triangle, ivec2(pixel), uvec4(hit.triangle));
}
