// The picture: f(y) · V(y) · W(y), the mean over the pixel's reservoirs, plus what the surface itself emits.
#include "mutants.glsl"
#include "reservoir.glsl"

void run(uvec2 pixel) {
  const uint index = pixel.y * frameWidth + pixel.x;
  vec3 color = imageLoad(in_emission, ivec2(pixel)).rgb;
  const PackedSurface packed = in_surface[index];
  if (isSurface(packed)) {
    const Surface surface = unpackSurface(packed, pixel, camera, frameSize);
    vec3 sum = vec3(0.0);
    for (uint k = 0u; k < in_reservoirs_count; ++k) {
      const Reservoir r = sanitized(in_reservoirs[index * in_reservoirs_count + k]);
      if (isNull(r)) continue;
      const LightSample light = evaluateLight(lightOf(r), r.place, surface.position);
      const vec3 f = unshadowed(surface, light);
      if (f == vec3(0.0)) continue;
      // A sample that was seen from this very pixel needs no second ray.
      float through = 1.0;
#ifdef FINAL_VISIBILITY
      if (MUTANT(1, false, !isSeen(r))) through = traceVisibility(surface, light);
#endif
      sum += MUTANT(29, min(f * (r.weight * through), vec3(1.0)), f * (r.weight * through));
    }
    color += sum / float(in_reservoirs_count);
  }
  imageStore(out_color, ivec2(pixel), vec4(color, 1.0));
}
