// A port as a picture on the canvas: each canvas pixel shows the port's pixel under its middle or, where the port is shrunk, the mean
// over its own area of what the port has there.
#include "settings.glsl"
#include "read.glsl"
#include "colour.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 2, rgba8) writeonly uniform image2D canvas;

const int kTaps = 32;  // at most so many each way; of larger areas a regular part is looked at

// Part of a port's axis that a canvas pixel shows; false outside of the port.
bool area(float at, float place, float scale, uint extent, out float low, out float high) {
  const float middle = (at + 0.5 - place) / scale, end = float(extent);
  if (!(middle >= 0.0 && middle < end)) return false;
  if (has(kBox) && scale < 1.0) {
    low = max((at - place) / scale, 0.0);
    high = min((at + 1.0 - place) / scale, end);
  } else {
    low = floor(middle);
    high = low + 1.0;
  }
  return high > low;
}

vec3 labelled(uint word) { return settings.shows == kLabel ? labelColor(word) : stateColor(word); }

// Where the port has nothing to say: dark, with stripes that no value has.
vec3 emptyColor(ivec2 at) { return vec3(((at.x + at.y) & 7) == 0 ? 0.20 : 0.10); }

vec3 colorAt(ivec2 at) {
  vec2 low, high;
  if (!area(float(at.x), settings.place.x, settings.scale.x, settings.extent.x, low.x, high.x) ||
      !area(float(at.y), settings.place.y, settings.scale.y, settings.extent.y, low.y, high.y))
    return unpackUnorm4x8(settings.background).rgb;
  const ivec2 first = ivec2(low), last = min(ivec2(ceil(high)), ivec2(settings.extent));
  const ivec2 step = max((last - first + kTaps - 1) / kTaps, ivec2(1));
  const bool named = settings.shows >= kLabel;
  const float whole = (high.x - low.x) * (high.y - low.y);
  vec3 sum = vec3(0.0);
  float weights = 0.0;
  for (int y = first.y; y < last.y; y += step.y) {
    for (int x = first.x; x < last.x; x += step.x) {
      const Value v = valueAt(uvec2(x, y));
      if (!v.there) continue;
      if (!named && !(isFinite(v.number.x) && isFinite(v.number.y) && isFinite(v.number.z))) return kNotFinite;
      const vec2 covered = min(vec2(x, y) + 1.0, high) - max(vec2(x, y), low);
      // Of the whole first: the largest numbers' sum has to stay finite.
      const float weight = covered.x * covered.y / whole;
      sum += weight * (named ? labelled(v.word) : v.number);
      weights += weight;
    }
  }
  if (!(weights > 0.0)) return emptyColor(at);
  sum /= weights;
  return named ? sum : colorOfNumbers(sum);
}

void main() {
  if (any(greaterThanEqual(gl_GlobalInvocationID.xy, settings.clipSize))) return;
  const ivec2 at = settings.clip + ivec2(gl_GlobalInvocationID.xy);
  imageStore(canvas, at, vec4(colorAt(at), 1.0));
}
