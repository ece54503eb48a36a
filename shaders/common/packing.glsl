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

// Albedo in 11 + 11 + 10 bits, spaced by square roots: fine steps where it is dark.
uint packAlbedo(vec3 c) {
  const vec3 s = sqrt(clamp(c, 0.0, 1.0));
  return uint(s.x * 2047.0 + 0.5) | (uint(s.y * 2047.0 + 0.5) << 11u) | (uint(s.z * 1023.0 + 0.5) << 22u);
}

vec3 unpackAlbedo(uint bits) {
  const vec3 s = vec3(bits & 2047u, (bits >> 11u) & 2047u, bits >> 22u) / vec3(2047.0, 2047.0, 1023.0);
  return s * s;
}

#endif
