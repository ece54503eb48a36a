// The shadow ray to each chosen sample: hidden ones are not passed on.
#include "reservoir.glsl"
#include "ray_order.glsl"

void run(uvec2 id) {
  uvec2 pixel;
  if (!pixelOfRay(id.x, pixel)) return;
  const uint index = pixel.y * frameWidth + pixel.x;
  for (uint k = 0u; k < out_reservoirs_count; ++k) {
    Reservoir r = out_reservoirs[index * out_reservoirs_count + k];
    if (isNull(r)) continue;
    testVisibility(r, unpackSurface(in_surface[index], pixel, camera, frameSize));
    out_reservoirs[index * out_reservoirs_count + k] = r;
  }
}
