// From a value to what the screen shows of it, in encoded sRGB.
#include "false_colour.glsl"

const vec3 kNotFinite = vec3(1.0, 0.0, 1.0);  // as in PNG files
const vec3 kBelow = vec3(0.0, 0.0, 1.0), kAbove = vec3(1.0, 0.0, 0.0);

// IEC 61966-2-1, as framework/image/png.cpp has it.
vec3 encodeSrgb(vec3 v) {
  return mix(1.055 * pow(max(v, 0.0031308), vec3(1.0 / 2.4)) - 0.055, 12.92 * v, lessThanEqual(v, vec3(0.0031308)));
}

bool has(uint flag) { return (settings.flags & flag) != 0u; }

// Where a value lies between low and high: in halves, so that the widest range has a finite width.
float inRange(float v) {
  float low = settings.low, high = settings.high;
  if (has(kSigned)) {
    high = max(abs(low), abs(high));
    low = 0.0;
  }
  if (has(kLogarithmic)) {
    if (!(v > 0.0)) return -1.0;
    if (!(high > 0.0)) return 2.0;
    low = low > 0.0 ? low : high * (1.0 / 65536.0);
    if (!(high > low)) return v >= high ? 1.0 : 0.0;
    return (log2(v) - log2(low)) / (log2(high) - log2(low));
  }
  const float width = 0.5 * high - 0.5 * low;
  return width > 0.0 ? (0.5 * v - 0.5 * low) / width : v >= high ? 1.0 : 0.0;
}

vec3 labelColor(uint label) {
  uint h = label * 747796405u + 2891336453u;
  h = ((h >> ((h >> 28u) + 4u)) ^ h) * 277803737u;
  h ^= h >> 22u;
  return vec3(h & 255u, (h >> 8u) & 255u, (h >> 16u) & 255u) * (0.8 / 255.0) + 0.2;
}

vec3 stateColor(uint state) {
  switch (state) {
    case 0u: return vec3(0.12);
    case 1u: return vec3(0.20, 0.35, 0.80);
    case 2u: return vec3(0.75);
    case 3u: return vec3(0.85, 0.25, 0.15);
    default: return vec3(0.25, 0.75, 0.30);
  }
}

// The hue is the way that it goes (right: red, down: yellow-green, left: cyan, up: violet), brightness how far against `high`.
vec3 directionColor(vec2 v) {
  const float far = length(v);
  if (!(far > 0.0)) return vec3(0.0);
  const float turn = atan(v.y, v.x) * (0.5 / 3.14159265) + 1.0;
  const vec3 hue = clamp(abs(fract(turn + vec3(0.0, 2.0, 1.0) / 3.0) * 6.0 - 3.0) - 1.0, 0.0, 1.0);
  return hue * clamp(settings.high > 0.0 ? far / settings.high : 1.0, 0.0, 1.0);
}

vec3 plain(vec3 t) { return has(kEncoded) && !has(kLogarithmic) ? encodeSrgb(t) : t; }

vec3 colorOfNumbers(vec3 v) {
  v *= settings.gain;
  if (settings.shows == kDirection) return directionColor(v.xy);
  if (has(kAbsolute)) v = abs(v);
  const bool alone = settings.shows == kNumber;
  if (has(kFalseColor) || has(kSigned)) {
    const float x = alone ? v.x : luminanceOf(v), t = inRange(has(kSigned) ? abs(x) : x);
    if (has(kMarkRange) && (t < 0.0 || t > 1.0)) return t < 0.0 ? kBelow : kAbove;
    const float inside = clamp(t, 0.0, 1.0);
    if (has(kFalseColor)) return falseColor(inside);
    return plain(x < 0.0 ? vec3(inside, 0.0, 0.0) : vec3(0.0, inside, 0.0));
  }
  const vec3 t = alone ? vec3(inRange(v.x)) : vec3(inRange(v.x), inRange(v.y), inRange(v.z));
  if (has(kMarkRange)) {
    if (any(greaterThan(t, vec3(1.0)))) return kAbove;
    if (any(lessThan(t, vec3(0.0)))) return kBelow;
  }
  return plain(clamp(t, 0.0, 1.0));
}
