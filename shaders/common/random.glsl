// Counter-based random numbers: a pure function of pixel, frame, dimension, stream (the pass) and seed.
// Hash: pcg4d of Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020.
#ifndef WEIR_RANDOM
#define WEIR_RANDOM

uvec4 pcg4d(uvec4 v) {
  v = v * 1664525u + 1013904223u;
  v.x += v.y * v.w;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v.w += v.y * v.z;
  v ^= v >> 16u;
  v.x += v.y * v.w;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v.w += v.y * v.z;
  return v;
}

// Uniform in [0, 1): 24 bits, so that 1 is never reached.
float uniformFloat(uint bits) { return float(bits >> 8u) * (1.0 / 16777216.0); }

struct Random {
  uvec3 key;  // pixel, frame, seed and stream
  uint dimension;
};

Random randomFor(uvec2 pixel, uint substream) {
  const uint place = pixel.x | (pixel.y << 16u);
  return Random(uvec3(place, frameIndex, frameSeed ^ (launchStream + substream * 0x9e3779b9u)), 0u);
}

// Four independent uniform numbers; each call takes the next dimension.
uvec4 nextBits4(inout Random r) { return pcg4d(uvec4(r.key.x, r.key.y, r.key.z, r.dimension++)); }
vec4 next4(inout Random r) {
  const uvec4 bits = nextBits4(r);
  return vec4(uniformFloat(bits.x), uniformFloat(bits.y), uniformFloat(bits.z), uniformFloat(bits.w));
}
vec2 next2(inout Random r) { return next4(r).xy; }
float next1(inout Random r) { return next4(r).x; }

#endif
