// Exposure, then the view transform that OpenColorIO wrote for this config (viewTransform, in memory only).
#include "view_transform.glsl"

// Between them, view transforms square and divide their values: what is larger than this (2^30) would overflow in some.
// Every view but a raw one has long been saturated by then.
const float kMost = 1073741824.0;

// NaN to 0, infinities to the largest values. By bits: a compiler may take isnan() to be always false.
float finite(float x) {
  if ((floatBitsToUint(x) & 0x7fffffffu) > 0x7f800000u) return 0.0;
  return clamp(x, -kMost, kMost);
}

vec3 finite(vec3 v) { return vec3(finite(v.r), finite(v.g), finite(v.b)); }

void run(uvec2 pixel) {
  const vec3 radiance = imageLoad(in_color, ivec2(pixel)).rgb;
  // exp2 of whole numbers need not be exact; ldexp is, so that +1 EV is exactly twice.
  const float exposure = ldexp(exp2(fract(param_exposure)), int(floor(param_exposure)));
  const vec3 shown = viewTransform(vec4(finite(radiance * exposure), 1.0)).rgb;
  imageStore(out_color, ivec2(pixel), vec4(shown, 1.0));
}
