// From a hit to the surface there: interpolation, textures, normal map, material; and from that to the packed surface.
#ifndef WEIR_HIT_SURFACE
#define WEIR_HIT_SURFACE

#include "material.glsl"
#include "rounding.glsl"
#include "scene.glsl"
#include "surface.glsl"
#include "trace_types.glsl"

// Keeps a shading normal from facing away from the viewer: mirrored at the plane across the view direction.
vec3 facingNormal(vec3 n, vec3 view) {
  const float d = dot(n, view);
  return d < 0.0 ? normalize(n - 2.0 * d * view) : n;
}

// In full precision. Both normals are turned towards the viewer.
struct HitSurface {
  vec3 position, geometricNormal, normal;
  Reflection reflection;
  vec3 emission;  // nit, towards the viewer
  float distance;
  float error;  // bound on the error of `position` by floating point, metres
};

// What the 16 + 16 bits of a vertex's normal may be off by, radians.
const float kVertexNormalError = 7e-5;

// Which texels a surface shows: those of a pixel, for camera rays, or level 0 for everything further along a path.
const bool kPixelTexels = true, kBaseTexels = false;

// Every component's terms of world · p, all positive: rounding is by a few 2^-24 of them.
vec3 termsOf(mat4x3 world, vec3 p) {
  return abs(world[0]) * abs(p.x) + abs(world[1]) * abs(p.y) + abs(world[2]) * abs(p.z) + abs(world[3]);
}

HitSurface surfaceAt(Hit hit, vec3 origin, vec3 direction, bool texels) {
  const uvec4 t = sceneTriangles[hit.triangle];
  const Instance instance = sceneInstances[hit.instance];
  const Material m = sceneMaterials[t.w];
  const vec3 b = vec3(1.0 - hit.barycentrics.x - hit.barycentrics.y, hit.barycentrics);
  const mat4x3 world = toWorld(instance);
  const vec3 corner0 = vertexPosition(t.x), corner1 = vertexPosition(t.y), corner2 = vertexPosition(t.z);
  const vec3 p0 = world * vec4(corner0, 1.0);
  const vec3 p1 = world * vec4(corner1, 1.0);
  const vec3 p2 = world * vec4(corner2, 1.0);

  HitSurface r;
  r.position = b.x * p0 + b.y * p1 + b.z * p2;
  // Four roundings a corner, four more between them; in units of 2^-23 that leaves a factor of two.
  const vec3 terms = max(max(termsOf(world, corner0), termsOf(world, corner1)), termsOf(world, corner2));
  r.error = max(terms.x, max(terms.y, terms.z)) * (8.0 / 8388608.0);
  vec3 geometric = normalize(cross(p1 - p0, p2 - p0));
  if (instance.flipsWinding != 0u) geometric = -geometric;
  const bool front = dot(geometric, direction) < 0.0;
  const float side = front ? 1.0 : -1.0;

  // Normals transform by the cofactor matrix, tangents by the matrix itself.
  const mat3 linear = mat3(world[0], world[1], world[2]);
  const float mirror = instance.flipsWinding != 0u ? -1.0 : 1.0;
  const mat3 cofactor =
      mat3(cross(linear[1], linear[2]), cross(linear[2], linear[0]), cross(linear[0], linear[1])) * mirror;
  const Vertex v0 = sceneVertices[t.x], v1 = sceneVertices[t.y], v2 = sceneVertices[t.z];
  vec3 n = cofactor * (b.x * unpackNormal(v0.normal) + b.y * unpackNormal(v1.normal) + b.z * unpackNormal(v2.normal));
  n = dot(n, n) > 0.0 ? normalize(n) : geometric;
  // A flat triangle's normal is its plane's: rounded at the vertices, it would be off the same way everywhere, and light that grazes
  // it by as much as that times tan θ.
  const vec3 off = cross(n, geometric);
  if (dot(off, off) < kVertexNormalError * kVertexNormalError && dot(n, geometric) > 0.0) n = geometric;
#ifdef SCENE_MIPMAPS
  Lookup at;
  if (texels == kPixelTexels) at = lookupAt(t, Corners(p0, p1, p2), hit, origin, direction);
  else at = baseLookupAt(t, hit);
#else
  const Lookup at = Lookup(coordinatesAt(t, hit.barycentrics));
#endif
  if (m.normalTexture >= 0) {
    const vec4 t0 = unpackTangent(v0.tangent), t1 = unpackTangent(v1.tangent), t2 = unpackTangent(v2.tangent);
    vec3 tangent = linear * (b.x * t0.xyz + b.y * t1.xyz + b.z * t2.xyz);
    tangent -= n * dot(n, tangent);
    if (dot(tangent, tangent) > 0.0) {
      tangent = normalize(tangent);
      const vec3 bitangent = cross(n, tangent) * (t0.w * mirror);
      vec3 mapped = look(m.normalTexture, at).xyz * 2.0 - 1.0;
      mapped.xy *= m.normalScale;
      const vec3 bent = tangent * mapped.x + bitangent * mapped.y + n * mapped.z;
      if (dot(bent, bent) > 0.0) n = normalize(bent);
    }
  }

  vec3 base = m.baseColor.rgb;
#ifdef SCENE_VERTEX_COLORS
  base *= colorAt(t, hit.barycentrics).rgb;
#endif
  if (m.baseColorTexture >= 0) base *= look(m.baseColorTexture, at).rgb;
  r.reflection = reflectionOf(t.w, base, at);
  r.emission = vec3(0.0);
  if ((m.flags & kMaterialEmissive) != 0u && (front || (m.flags & kMaterialDoubleSided) != 0u)) {
    r.emission = m.emission;
    if (m.emissiveTexture >= 0) r.emission *= look(m.emissiveTexture, at).rgb;
  }
#ifdef SCENE_UNLIT
  if ((m.flags & kMaterialUnlit) != 0u) r.emission = base;
#endif

  r.distance = length(r.position - origin);
  r.geometricNormal = geometric * side;
  r.normal = facingNormal(n * side, -direction);
  return r;
}

// `jitter` 0 … 254 a side: where in its pixel the ray was shot (127: the centre). All that is rounded, but for the geometric normal, is
// rounded by uniform numbers.
PackedSurface packSurface(HitSurface s, uvec2 jitter, Rounding u) {
  const uint roughness = packRoughness(s.reflection.roughness, s.reflection.f90, vec2(u.roughness, u.f90));
  PackedSurface p;
  p.distance = s.distance;
  p.geometricNormal = packNormal(s.geometricNormal);
  p.shadingNormal = packNormalBy(s.normal, u.normal);
  p.diffuse = packAlbedo(s.reflection.diffuse, u.diffuse);
  p.specular = packAlbedo(s.reflection.f0, u.specular);
  p.roughnessJitter = jitter.x | (jitter.y << 8u) | (roughness << 16u);
  return p;
}

// What would be unpacked from that, but for the rounding.
Surface surfaceFrom(HitSurface hit, vec3 direction) {
  Surface s;
  s.position = hit.position;
  s.geometricNormal = hit.geometricNormal;
  s.normal = hit.normal;
  s.view = -direction;
  s.diffuse = clamp(hit.reflection.diffuse, 0.0, 1.0);
  s.f0 = clamp(hit.reflection.f0, 0.0, 1.0);
#ifdef SCENE_F90
  s.f90 = clamp(hit.reflection.f90, 0.0, 1.0);
#endif
  const float roughness = clamp(hit.reflection.roughness, 0.0, 1.0);
  s.alpha = max(roughness * roughness, kSmallestAlpha);
  s.distance = hit.distance;
  s.error = hit.error;
  finishSurface(s);
  return s;
}

PackedSurface noSurface() { return PackedSurface(0.0, 0u, 0u, 0u, 0u, 0x7f7fu); }

#endif
