// The first visible surface of a pixel, 24 bytes, and what it unpacks to. The struct PackedSurface itself is generated from
// passes/common/layouts.h.
#ifndef WEIR_SURFACE
#define WEIR_SURFACE

#include "camera.glsl"
#include "packing.glsl"

struct Surface {
  vec3 position;
  vec3 geometricNormal;  // faces the viewer
  vec3 normal;           // shading normal, never faces away from the viewer
  vec3 view;             // unit, towards the camera
  vec3 diffuse;          // c_diff of glTF 2.0 appendix B
  vec3 f0;
#ifdef SCENE_F90
  float f90;  // reflectance at grazing angles; 1 where scenes lack the trait
#endif
#ifdef SCENE_ENERGY_COMPENSATION
  vec3 compensation;  // of the specular lobe, 1 and more
#endif
  float alpha;  // GGX α = roughness²
  float distance;
  float error;  // bound on the error of `position` by floating point, metres
};

// Smallest α that is told from a mirror: D(0) stays finite for delta lights.
const float kSmallestAlpha = 1.0 / 2048.0;

bool isSurface(PackedSurface p) { return p.distance > 0.0; }

// Where inside its pixel a surface was sampled: (b + 0.5) / 255, so that 127 is the centre.
vec2 unpackJitter(uint bits) { return (vec2(bits & 255u, (bits >> 8u) & 255u) + 0.5) / 255.0; }

// Rounding of origin + distance · direction with a direction of a few ulp, as a multiple of 2^-23 of the largest term.
float positionError(vec3 position, vec3 origin, float distance) {
  const vec3 largest = max(abs(position), abs(origin));
  return (max(largest.x, max(largest.y, largest.z)) + distance) * (8.0 / 8388608.0);
}

// Roughness in 16 bits; where surfaces differ in F90, roughness in 10 and that in 6. Rounded by uniform numbers.
uint packRoughness(float roughness, float f90, vec2 u) {
#ifdef SCENE_F90
  return (roundBy(clamp(roughness, 0.0, 1.0) * 1023.0, u.x) << 6u) | roundBy(clamp(f90, 0.0, 1.0) * 63.0, u.y);
#else
  return roundBy(clamp(roughness, 0.0, 1.0) * 65535.0, u.x);
#endif
}

#ifdef SCENE_ENERGY_COMPENSATION
// E: what the specular lobe reflects of light from all around (or, seen the other way, of a ray) without absorption; at most 7.2e-4
// of it off. The table and its coordinates: framework/scene/specular_albedo.h.
float specularAlbedo(float nv, float alpha) {
  const float x = 63.0 * sqrt(clamp(nv * (1.0 + alpha) / (nv + alpha), 0.0, 1.0)), y = 31.0 * alpha;
  const uint column = min(uint(x), 62u), row = min(uint(y), 30u), at = 64u * row + column;
  const float low = mix(sceneSpecularAlbedo[at], sceneSpecularAlbedo[at + 1u], x - float(column));
  const float high = mix(sceneSpecularAlbedo[at + 64u], sceneSpecularAlbedo[at + 65u], x - float(column));
  return mix(low, high, y - float(row));
}
#endif

// What follows from the rest of a surface. Everything that makes one calls this last.
void finishSurface(inout Surface s) {
  // Rounding may have turned the normal away again, where densities that rest on n·v = 0 would not be those of what is sampled.
  const float nv = dot(s.normal, s.view);
  if (nv < 0.0) s.normal = normalize(s.normal - nv * s.view);
#ifdef SCENE_ENERGY_COMPENSATION
  // Turquin 2019, eq. 16: the light that the lobe loses comes back with F0 for what each further reflection keeps of it. F0 and not
  // an average over angles: without absorption it is exact, else a little dark, never more than was lost.
  const float albedo = specularAlbedo(max(nv, 0.0), s.alpha);
  s.compensation = 1.0 + s.f0 * ((1.0 - albedo) / albedo);
#endif
}

float roughnessOf(PackedSurface p) {
#ifdef SCENE_F90
  return float(p.roughnessJitter >> 22u) / 1023.0;
#else
  return float(p.roughnessJitter >> 16u) / 65535.0;
#endif
}

vec3 surfaceNormal(PackedSurface p) { return unpackNormal(p.shadingNormal); }

Surface unpackSurface(PackedSurface p, uvec2 pixel, Camera camera, vec2 size) {
  Surface s;
  const vec2 point = vec2(pixel) + unpackJitter(p.roughnessJitter);
  const vec3 direction = cameraDirection(camera, point, size);
  s.distance = p.distance;
  s.position = camera.origin.xyz + p.distance * direction;
  s.geometricNormal = unpackNormal(p.geometricNormal);
  s.normal = unpackNormal(p.shadingNormal);
  s.view = -direction;
  s.diffuse = unpackAlbedo(p.diffuse);
  s.f0 = unpackAlbedo(p.specular);
#ifdef SCENE_F90
  s.f90 = float((p.roughnessJitter >> 16u) & 63u) / 63.0;
#endif
  const float roughness = roughnessOf(p);
  s.alpha = max(roughness * roughness, kSmallestAlpha);
  s.error = positionError(s.position, camera.origin.xyz, p.distance);
  finishSurface(s);
  return s;
}

#endif
