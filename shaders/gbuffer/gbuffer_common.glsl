// What both G-buffers write for a pixel.
#include "gbuffer_jitter.glsl"
#include "hit_surface.glsl"
#include "previous.glsl"
#ifdef SCENE_ENVIRONMENT
#include "environment.glsl"
#endif

const float kInfinity = 3.0e38;

void writePixel(uvec2 pixel, Hit hit, vec3 direction, uvec2 jitter) {
  const vec2 point = vec2(pixel) + jitterPlace(jitter);
  const uint index = pixel.y * frameWidth + pixel.x;
  vec3 before;  // where last frame's camera saw what this pixel shows
  if (hit.triangle == kNoTriangle) {
    out_surface[index] = noSurface();
    vec3 background = vec3(0.0);
#ifdef SCENE_ENVIRONMENT
    background = environmentRadiance(direction);
#endif
    imageStore(out_emission, ivec2(pixel), vec4(background, 0.0));
    before = cameraProject(previousCamera, previousCamera.origin.xyz + direction, frameSize);
  } else {
    const HitSurface s = surfaceAt(hit, camera.origin.xyz, direction, kPixelTexels);
    out_surface[index] = packSurface(s, jitter, roundingFor(pixel));
    imageStore(out_emission, ivec2(pixel), vec4(s.emission, 1.0));
    before = cameraProject(previousCamera, previousPosition(hit, s.position), frameSize);
  }
  // Behind last frame's camera: nowhere on its picture.
  const vec2 motion = before.z > 0.0 ? before.xy - point : vec2(kInfinity);
  imageStore(out_motion, ivec2(pixel), vec4(motion, 0.0, 0.0));
}
