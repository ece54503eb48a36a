// The final shadow rays, apart from the arithmetic: takes back what is hidden.
#include "reservoir.glsl"

void run(uvec2 pixel) {
  const uint index = pixel.y * frameWidth + pixel.x;
  Reservoir r = in_reservoirs[index];
  if (!(r.weight > 0.0) || isSeen(r) || lightOf(r) >= lightCount()) return;
  const Surface surface = unpackSurface(in_surface[index], pixel, camera, frameSize);
  const LightSample light = evaluateLight(lightOf(r), r.place, surface.position);
  if (!(dot(surface.geometricNormal, light.direction) > 0.0)) return;
  const float through = traceVisibility(surface, light);
  if (through >= 1.0) return;
  const vec3 emission = imageLoad(in_emission, ivec2(pixel)).rgb;
  vec3 color = emission;
  if (through > 0.0) color += through * (imageLoad(out_color, ivec2(pixel)).rgb - emission);
  imageStore(out_color, ivec2(pixel), vec4(color, 1.0));
#ifdef wanted_out_tested
  if (through <= 0.0) {
    r.light |= kSeen;
    r.weight = 0.0;
    out_tested[index] = r;
  }
#endif
}
