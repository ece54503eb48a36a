// The shadow ray of a reservoir's sample.
#include "reservoir.glsl"

void run(uvec2 pixel) {
  const uint index = pixel.y * frameWidth + pixel.x;
  const PackedSurface packed = in_surface[index];
  const Reservoir r = sanitized(in_reservoirs[index * in_reservoirs_count]);
  float through = -1.0;
  if (isSurface(packed) && !isNull(r)) {
    const Surface surface = unpackSurface(packed, pixel, camera, frameSize);
    through = traceVisibility(surface, evaluateLight(lightOf(r), r.place, surface.position));
  }
  imageStore(out_transmittance, ivec2(pixel), vec4(through));
}
