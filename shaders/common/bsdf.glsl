// glTF 2.0, appendix B: Lambert under GGX with height-correlated Smith shadowing and Schlick's Fresnel term. With
// SCENE_ENERGY_COMPENSATION the specular lobe is scaled by a factor of the view's angle (surface.glsl): reciprocal no longer.
#ifndef WEIR_BSDF
#define WEIR_BSDF

#include "mutants.glsl"
#include "surface.glsl"

const float kPi = 3.14159265358979;

float luminance(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }

// D of Walter et al. 2007, written so that it keeps its precision near the peak: |n × h|² instead of 1 - (n·h)².
float ggxD(vec3 n, vec3 h, float alpha) {
  const vec3 c = cross(n, h);
  const float nh = dot(n, h);
  if (nh <= 0.0) return 0.0;
  const float a2 = alpha * alpha;
  const float d = dot(c, c) + a2 * nh * nh;
  return a2 / (kPi * d * d);
}

// G2 / (4 n·l n·v), height-correlated (Heitz 2014).
float ggxVisibility(float nl, float nv, float alpha) {
  const float a2 = alpha * alpha;
  const float gv = nl * sqrt(nv * nv * (1.0 - a2) + a2);
  const float gl = nv * sqrt(nl * nl * (1.0 - a2) + a2);
  return MUTANT(45, 1.0 / ((nl + sqrt(nl * nl * (1.0 - a2) + a2)) * (nv + sqrt(nv * nv * (1.0 - a2) + a2))), 0.5 / (gv + gl));
}

vec3 schlick(Surface s, float vh) {
  const float m = clamp(1.0 - vh, 0.0, 1.0);
  const float m2 = m * m;
#ifdef SCENE_F90
  return s.f0 + (s.f90 - s.f0) * (m2 * m2 * m);
#else
  return s.f0 + (1.0 - s.f0) * (m2 * m2 * m);
#endif
}

// BSDF times cosine for light from `l` (unit). Zero below the geometric or the shading surface.
vec3 bsdfCos(Surface s, vec3 l) {
  const float nl = dot(s.normal, l);
  if (nl <= 0.0 || dot(s.geometricNormal, l) <= 0.0) return vec3(0.0);
  const float nv = max(dot(s.normal, s.view), 0.0);
  const vec3 h = normalize(l + s.view);
  const vec3 f = schlick(s, MUTANT(44, nv, dot(s.view, h)));
  const vec3 diffuse = MUTANT(46, vec3(1.0), 1.0 - f) * s.diffuse / kPi;
  vec3 specular = f * (ggxD(s.normal, h, s.alpha) * ggxVisibility(nl, nv, s.alpha));
#ifdef SCENE_ENERGY_COMPENSATION
  specular *= s.compensation;
#endif
  return (diffuse + specular) * nl;
}

#endif
