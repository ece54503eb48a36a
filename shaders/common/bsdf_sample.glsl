// Directions drawn nearly in proportion to the BSDF of bsdf.glsl: the specular lobe by the visible normals of GGX (Heitz, "Sampling the
// GGX Distribution of Visible Normals", JCGT 7(4), 2018), found by spherical caps (Dupuy and Benyoub, "Sampling Visible GGX Normals
// with Spherical Caps", HPG 2023), the diffuse one by the cosine.
#ifndef WEIR_BSDF_SAMPLE
#define WEIR_BSDF_SAMPLE

#include "mutants.glsl"
#include "bsdf.glsl"

// Right-handed, with n as its z axis (Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017).
mat3 basisAround(vec3 n) {
  const float side = n.z >= 0.0 ? 1.0 : -1.0;
  const float a = -1.0 / (side + n.z), b = n.x * n.y * a;
  return mat3(vec3(1.0 + side * n.x * n.x * a, side * b, -side * n.x), vec3(b, side + n.y * n.y * a, -n.y), n);
}

// With which probability the specular lobe is drawn from: about its share of what is reflected.
float specularShare(Surface s) {
  const vec3 f = schlick(s, max(dot(s.normal, s.view), 0.0));
#ifdef SCENE_ENERGY_COMPENSATION
  const float specular = luminance(f * s.compensation), diffuse = luminance((1.0 - f) * s.diffuse);
#else
  const float specular = luminance(f), diffuse = luminance((1.0 - f) * s.diffuse);
#endif
  return specular + diffuse > 0.0 ? specular / (specular + diffuse) : 0.0;
}

// Unit direction by the specular lobe alone. It may lie below the surface, where bsdfCos() is zero. Scaled by 1/α along the surface, the
// lobe's normals are those of a half sphere; a mirror half sphere sends the view into a uniformly lit cap, from -v.z up to the pole.
vec3 sampleSpecular(Surface s, vec2 u) {
  const mat3 world = basisAround(s.normal);
  const vec3 view = s.view * world;
  const vec3 v = normalize(vec3(s.alpha * view.xy, max(view.z, 0.0)));
  // Height 1 - down on the sphere; its sum with v.z, written so that it stays above 0.
  const float down = u.x * (1.0 + v.z), height = max(1.0 - u.x, 1.0 / 16777216.0) * (1.0 + v.z), angle = 2.0 * kPi * u.y;
  const vec2 across = sqrt(down * (2.0 - down)) * vec2(cos(angle), sin(angle));
  const vec3 h = normalize(world * vec3(s.alpha * (across + v.xy), height));
  return normalize(2.0 * dot(s.view, h) * h - s.view);
}

// Density of sampleSpecular() per steradian: G1(v) D / (4 n·v).
float specularDensity(Surface s, vec3 l) {
  const float nv = max(dot(s.normal, s.view), 0.0), a2 = s.alpha * s.alpha;
  const vec3 sum = l + s.view;
  if (!(dot(sum, sum) > 0.0)) return 0.0;
  return ggxD(s.normal, normalize(sum), s.alpha) / (2.0 * (nv + sqrt(a2 + (1.0 - a2) * nv * nv)));
}

// Unit direction from three uniform numbers. It may lie below the surface, where bsdfCos() is zero.
vec3 sampleBsdf(Surface s, vec3 u) {
  if (u.z < specularShare(s)) return sampleSpecular(s, u.xy);
  const float r = sqrt(u.x), angle = 2.0 * kPi * u.y;
  return normalize(basisAround(s.normal) * vec3(r * cos(angle), r * sin(angle), sqrt(1.0 - u.x)));
}

// Density of sampleBsdf() per steradian.
float bsdfDensity(Surface s, vec3 l) {
  return mix(max(dot(s.normal, l), 0.0) / kPi, specularDensity(s, l), MUTANT(63, 0.5, specularShare(s)));
}

// Below this α the specular lobe is so narrow that points on lights must be looked for along it: its peak is 1 / (π α²).
const float kGlossyAlpha = 0.25;
bool isGlossy(Surface s) { return s.alpha < kGlossyAlpha; }

#endif
