// Numbers in few bits. Octahedral normals: Cigolle et al., "A Survey of Efficient Representations for Independent Unit Vectors", JCGT 3(2), 2014.
#ifndef WEIR_PACKING
#define WEIR_PACKING

vec2 signNotZero(vec2 v) { return vec2(v.x >= 0.0 ? 1.0 : -1.0, v.y >= 0.0 ? 1.0 : -1.0); }

uint packNormal(vec3 n) {
  vec2 p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
  if (n.z < 0.0) p = (1.0 - abs(p.yx)) * signNotZero(p);
  return packSnorm2x16(p);
}

vec3 unpackNormal(uint bits) {
  const vec2 p = unpackSnorm2x16(bits);
  vec3 n = vec3(p, 1.0 - abs(p.x) - abs(p.y));
  if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * signNotZero(n.xy);
  return normalize(n);
}

// A tangent keeps the sign of the bitangent in the lowest bit of its upper half.
vec4 unpackTangent(uint bits) {
  return vec4(unpackNormal(bits & 0xfffeffffu), (bits & 0x10000u) != 0u ? -1.0 : 1.0);
}

uint packTangent(vec4 t) { return (packNormal(t.xyz) & 0xfffeffffu) | (t.w < 0.0 ? 0x10000u : 0u); }

// The code above or below x >= 0, whichever the uniform number u in [0, 1) says, so that the mean over u is x: nothing is gained or
// lost however many pixels and frames come together. u = 1/2 rounds to the nearest. Whole numbers stay what they are.
uint roundBy(float x, float u) {
  const float low = floor(x);
  return uint(low) + (u < x - low ? 1u : 0u);
}

// The same for codes k that stand for (k / steps)²: between neighbours the mean is linear in the probability, which is therefore that of
// the squares. (Rounding the root so that its own mean is kept would add the variance of the root to the value.)
uint roundRootBy(float value, float steps, float u) {
  const float x = clamp(value, 0.0, 1.0), low = min(floor(sqrt(x) * steps), steps);
  return uint(low) + (u < (x * steps * steps - low * low) / (2.0 * low + 1.0) ? 1u : 0u);
}

// Octahedral, with each coordinate rounded by a uniform number.
uint packNormalBy(vec3 n, vec2 u) {
  vec2 p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
  if (n.z < 0.0) p = (1.0 - abs(p.yx)) * signNotZero(p);
  p = clamp(p, -1.0, 1.0) * 32767.0;
  const vec2 low = floor(p);
  const ivec2 code = ivec2(low) + ivec2(lessThan(u, p - low));
  return (uint(code.x) & 0xffffu) | (uint(code.y) << 16u);
}

// Albedo in 11 + 11 + 10 bits, spaced by square roots: fine steps where it is dark. Each channel is rounded by a uniform number.
uint packAlbedo(vec3 c, vec3 u) {
  return roundRootBy(c.x, 2047.0, u.x) | (roundRootBy(c.y, 2047.0, u.y) << 11u) | (roundRootBy(c.z, 1023.0, u.z) << 22u);
}

vec3 unpackAlbedo(uint bits) {
  const vec3 s = vec3(bits & 2047u, (bits >> 11u) & 2047u, bits >> 22u) / vec3(2047.0, 2047.0, 1023.0);
  return s * s;
}

#endif
