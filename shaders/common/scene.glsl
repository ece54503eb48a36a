// Reading the scene: geometry, materials, textures. The buffers themselves are declared by the generated prelude, and only
// those that the pass's description asks for.
#ifndef WEIR_SCENE
#define WEIR_SCENE

#include "packing.glsl"

const uint kMaterialMask = 1u, kMaterialBlend = 2u, kMaterialDoubleSided = 4u, kMaterialEmissive = 8u,
           kMaterialSpecularGlossiness = 16u, kMaterialUnlit = 32u;

#ifdef NEED_SCENE_GEOMETRY
vec3 vertexPosition(uint v) { return vec3(scenePositions[3u * v], scenePositions[3u * v + 1u], scenePositions[3u * v + 2u]); }

// Index of a hit's triangle: a bottom-level structure holds opaque triangles (geometry 0), then those with alpha (geometry 1).
uint hitTriangle(uint instance, uint geometry, uint primitive) {
  const Instance i = sceneInstances[instance];
  return i.firstTriangle + (geometry != 0u ? i.opaqueTriangles : 0u) + primitive;
}

mat4x3 toWorld(Instance i) { return mat4x3(i.column0.xyz, i.column1.xyz, i.column2.xyz, i.column3.xyz); }
#endif

#ifdef NEED_SCENE_MATERIALS
// Texture coordinates at a place on a triangle: one set, or two where some material reads both.
struct Coordinates {
  vec2 set0;
#ifdef SCENE_UV_SETS
  vec2 set1;
#endif
};

Coordinates coordinatesAt(uvec4 triangle, vec2 barycentrics) {
  Coordinates c;
  const vec2 a = sceneVertices[triangle.x].uv, b = sceneVertices[triangle.y].uv, d = sceneVertices[triangle.z].uv;
  c.set0 = a + barycentrics.x * (b - a) + barycentrics.y * (d - a);
#ifdef SCENE_UV_SETS
  const vec2 e = sceneUvs1[triangle.x], f = sceneUvs1[triangle.y], g = sceneUvs1[triangle.z];
  c.set1 = e + barycentrics.x * (f - e) + barycentrics.y * (g - e);
#endif
  return c;
}

// Which set a texture reads.
vec2 setOf(int texture, Coordinates c) {
#ifdef SCENE_UV_SETS
  if (sceneTextureUses[texture].uvSet != 0u) return c.set1;
#endif
  return c.set0;
}

// A difference of coordinates, as the texture sees it.
vec2 edgeIn(int texture, vec2 edge) {
#ifdef SCENE_UV_TRANSFORMS
  const vec4 linear = sceneTextureUses[texture].linear;
  return mat2(linear.xy, linear.zw) * edge;
#else
  return edge;
#endif
}

// Where a texture is read.
vec2 placeIn(int texture, Coordinates c) {
  const vec2 uv = edgeIn(texture, setOf(texture, c));
#ifdef SCENE_UV_TRANSFORMS
  return uv + sceneTextureUses[texture].offset;
#else
  return uv;
#endif
}

// Level 0, whatever a pixel covers: coverage and light sampling stay exact in the mean, and agree between camera and shadow rays.
vec4 sampleTexture(int texture, Coordinates c) {
  return textureLod(sceneTextures[nonuniformEXT(texture)], placeIn(texture, c), 0.0);
}

#ifdef SCENE_VERTEX_COLORS
// Colours are stored as their square roots, alpha as it is.
vec4 vertexColor(uint v) {
  const vec4 c = vec4(unpackUnorm2x16(sceneColors[v].x), unpackUnorm2x16(sceneColors[v].y));
  return vec4(c.rgb * c.rgb, c.a);
}

vec4 colorAt(uvec4 triangle, vec2 barycentrics) {
  const vec4 a = vertexColor(triangle.x);
  return a + barycentrics.x * (vertexColor(triangle.y) - a) + barycentrics.y * (vertexColor(triangle.z) - a);
}
#endif

vec3 emissionTexture(uint triangle, vec2 barycentrics) {
  const uvec4 t = sceneTriangles[triangle];
  const int texture = sceneMaterials[t.w].emissiveTexture;
  return texture >= 0 ? sampleTexture(texture, coordinatesAt(t, barycentrics)).rgb : vec3(1.0);
}

// Coverage of a triangle with alpha, 0 … 1: a mask is all or nothing.
float triangleCoverage(uint triangle, vec2 barycentrics) {
  const uvec4 t = sceneTriangles[triangle];
  const Material m = sceneMaterials[t.w];
  float alpha = m.baseColor.a;
#ifdef SCENE_VERTEX_COLORS
  alpha *= colorAt(t, barycentrics).a;
#endif
  if (m.baseColorTexture >= 0) alpha *= sampleTexture(m.baseColorTexture, coordinatesAt(t, barycentrics)).a;
  if ((m.flags & kMaterialMask) != 0u) return alpha >= m.alphaCutoff ? 1.0 : 0.0;
  return (m.flags & kMaterialBlend) != 0u ? clamp(alpha, 0.0, 1.0) : 1.0;
}
#endif

#endif
