// From a hit to the packed surface: interpolation, textures, normal map, material.
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

struct HitSurface {
  PackedSurface surface;
  vec3 emission;  // nit, towards the viewer
  vec3 position;
};

// What the 16 + 16 bits of a vertex's normal may be off by, radians.
const float kVertexNormalError = 7e-5;

// `jitter` 0 … 254 a side: where in its pixel the ray was shot (127: the centre). Everything that is packed is rounded by `rounding`.
HitSurface surfaceAt(Hit hit, vec3 origin, vec3 direction, uvec2 jitter, Rounding rounding) {
  const uvec4 t = sceneTriangles[hit.triangle];
  const Instance instance = sceneInstances[hit.instance];
  const Material m = sceneMaterials[t.w];
  const vec3 b = vec3(1.0 - hit.barycentrics.x - hit.barycentrics.y, hit.barycentrics);
  const mat4x3 world = toWorld(instance);
  const vec3 p0 = world * vec4(vertexPosition(t.x), 1.0);
  const vec3 p1 = world * vec4(vertexPosition(t.y), 1.0);
  const vec3 p2 = world * vec4(vertexPosition(t.z), 1.0);

  HitSurface r;
  r.position = b.x * p0 + b.y * p1 + b.z * p2;
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
  const Lookup at = lookupAt(t, Corners(p0, p1, p2), hit, origin, direction);
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
  const Reflection reflection = reflectionOf(t.w, base, at);
  r.emission = vec3(0.0);
  if ((m.flags & kMaterialEmissive) != 0u && (front || (m.flags & kMaterialDoubleSided) != 0u)) {
    r.emission = m.emission;
    if (m.emissiveTexture >= 0) r.emission *= look(m.emissiveTexture, at).rgb;
  }
#ifdef SCENE_UNLIT
  if ((m.flags & kMaterialUnlit) != 0u) r.emission = base;
#endif

  const vec3 view = -direction;
  r.surface.distance = length(r.position - origin);
  r.surface.geometricNormal = packNormal(geometric * side);
  r.surface.shadingNormal = packNormalBy(facingNormal(n * side, view), rounding.normal);
  r.surface.diffuse = packAlbedo(reflection.diffuse, rounding.diffuse);
  r.surface.specular = packAlbedo(reflection.f0, rounding.specular);
  const uint roughness = packRoughness(reflection.roughness, reflection.f90, vec2(rounding.roughness, rounding.f90));
  r.surface.roughnessJitter = jitter.x | (jitter.y << 8u) | (roughness << 16u);
  return r;
}

PackedSurface noSurface() { return PackedSurface(0.0, 0u, 0u, 0u, 0u, 0x7f7fu); }

#endif
