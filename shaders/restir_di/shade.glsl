// The picture: f(y) · V(y) · W(y), the mean over the pixel's reservoirs, plus what the surface itself emits.
#include "mutants.glsl"
#include "reservoir.glsl"

// f · V · W; `r` is then what is known of its sample: a null sample, marked, if it is hidden.
vec3 shade(inout Reservoir r, Surface surface) {
  if (isNull(r)) return vec3(0.0);
  const LightSample light = evaluateLight(lightOf(r), r.place, surface.position);
  const vec3 f = unshadowed(surface, light);
  if (f == vec3(0.0)) {
    r = nullReservoir(r.confidence);
    return vec3(0.0);
  }
  const float weight = r.weight;
  float through = 1.0;
#ifdef FINAL_VISIBILITY
  // A sample that was seen from this very pixel needs no second ray.
  if (MUTANT(1, false, !isSeen(r))) through = traceVisibility(surface, light);
  if (through <= 0.0) {
    r.light |= kSeen;
    r.weight = 0.0;
  }
#endif
  return MUTANT(29, min(f * (weight * through), vec3(1.0)), f * (weight * through));
}

void run(uvec2 pixel) {
  const uint index = pixel.y * frameWidth + pixel.x;
  vec3 color = imageLoad(in_emission, ivec2(pixel)).rgb;
  const PackedSurface packed = in_surface[index];
  const bool lit = isSurface(packed);
  Surface surface;
  if (lit) surface = unpackSurface(packed, pixel, camera, frameSize);
  vec3 sum = vec3(0.0);
  for (uint k = 0u; k < in_reservoirs_count; ++k) {
    const uint at = index * in_reservoirs_count + k;
    Reservoir r = emptyReservoir();
    if (lit) {
      r = sanitized(in_reservoirs[at]);
      sum += shade(r, surface);
    }
#ifdef wanted_out_tested
    out_tested[at] = r;
#endif
  }
  imageStore(out_color, ivec2(pixel), vec4(color + sum / float(in_reservoirs_count), 1.0));
}
