// What packing makes of one value a pixel, in the mean over evenly spread uniform numbers: sums of differences, so that single precision
// is enough.
#include "packing.glsl"

const uint kSteps = 4096u;

void run(uvec2 pixel) {
  const uint index = pixel.y * frameWidth + pixel.x;
  const float value = in_values[index].value;
  const vec3 nearest = unpackAlbedo(packAlbedo(vec3(value), vec3(0.5)));
  Rounded r = Rounded(0.0, 0.0, nearest.x - value, nearest.z - value, 0.0, 0.0, 0.0, 0.0, 0.0);
  const float angle = 6.2831853 * value, height = 2.0 * fract(value * 41.0) - 1.0;
  const vec3 n = vec3(sqrt(1.0 - height * height) * vec2(cos(angle), sin(angle)), height);
  vec3 normal = vec3(0.0);
  for (uint k = 0u; k < kSteps; ++k) {
    const float u = (float(k) + 0.5) / float(kSteps);
    const vec3 c = unpackAlbedo(packAlbedo(vec3(value), vec3(u)));
    r.fine += (c.x - value) / float(kSteps);
    r.coarse += (c.z - value) / float(kSteps);
    r.linear += (float(roundBy(value * 1023.0, u)) / 1023.0 - value) / float(kSteps);
    // 64 by 64 places for the two coordinates of a normal.
    const vec2 uv = (vec2(k % 64u, k / 64u) + 0.5) / 64.0;
    const vec3 off = unpackNormal(packNormalBy(n, uv)) - n;
    normal += off / float(kSteps);
    r.farthest = max(r.farthest, length(off));
  }
  r.normal = length(normal);
  r.nearestNormal = length(unpackNormal(packNormal(n)) - n);
  out_rounded[index] = r;
}
