// The picture: f(y) · V(y) · W(y), the mean over the pixel's reservoirs, plus what the surface itself emits. Here V is 1;
// shade_visibility.glsl then shoots the rays of those samples that are not known to be seen, takes back what is hidden, and marks the
// reservoirs with what it found.
//
// With what the spatial merge found, Σ m_i f(y_i) W_i, the chosen sample y says only how much of that is hidden:
// Σ m_i f(y_i) W_i + f(y) W (V(y) - 1) has the same mean (y is chosen so that f(y) W has that of the sum), and where y is seen it
// doesn't matter which of the samples it was.
#include "mutants.glsl"
#include "reservoir.glsl"
#ifdef FINAL_VISIBILITY
#include "ray_order.glsl"
#endif

void run(uvec2 pixel) {
  const uint index = pixel.y * frameWidth + pixel.x;
  bool ray = false;
  vec3 towards = vec3(0.0), sum = vec3(0.0);
  const PackedSurface packed = in_surface[index];
  if (isSurface(packed)) {
    const Surface surface = unpackSurface(packed, pixel, camera, frameSize);
    for (uint k = 0u; k < in_reservoirs_count; ++k) {
      const Reservoir r = sanitized(in_reservoirs[index * in_reservoirs_count + k]);
#ifdef wanted_out_reservoirs
      out_reservoirs[index * in_reservoirs_count + k] = r;
#endif
      if (isNull(r)) continue;
      const LightSample light = evaluateLight(lightOf(r), r.place, surface.position);
      const vec3 f = unshadowed(surface, light);
      if (f == vec3(0.0)) continue;
      sum += MUTANT(29, min(f * r.weight, vec3(1.0)), f * r.weight);
      // A sample that was seen from this very pixel needs no second ray.
      if (MUTANT(1, false, !isSeen(r))) {
        ray = true;
        towards = light.direction;
      }
    }
    sum /= float(in_reservoirs_count);
#ifdef has_in_light
    sum = imageLoad(in_light, ivec2(pixel)).rgb;
#endif
  }
#ifdef wanted_out_reservoirs
  if (!isSurface(packed)) {
    for (uint k = 0u; k < in_reservoirs_count; ++k) out_reservoirs[index * in_reservoirs_count + k] = emptyReservoir();
  }
#endif
  imageStore(out_color, ivec2(pixel), vec4(imageLoad(in_emission, ivec2(pixel)).rgb + sum, 1.0));
#ifdef FINAL_VISIBILITY
  scratch_keys[index].bits = ray ? rayKey(towards) : kNoRayKey;
#endif
}
