// Reading the scene: geometry, materials, textures. The buffers themselves are declared by the generated prelude, and only
// those that the pass's description asks for.
#ifndef WEIR_SCENE
#define WEIR_SCENE

#include "packing.glsl"

const uint kMaterialMask = 1u, kMaterialBlend = 2u, kMaterialDoubleSided = 4u, kMaterialEmissive = 8u;

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
vec2 triangleUv(uint triangle, vec2 barycentrics) {
  const uvec4 t = sceneTriangles[triangle];
  const vec2 uv0 = sceneVertices[t.x].uv, uv1 = sceneVertices[t.y].uv, uv2 = sceneVertices[t.z].uv;
  return uv0 + barycentrics.x * (uv1 - uv0) + barycentrics.y * (uv2 - uv0);
}

vec4 sampleTexture(int index, vec2 uv) { return textureLod(sceneTextures[nonuniformEXT(index)], uv, 0.0); }

vec3 emissionTexture(uint triangle, vec2 barycentrics) {
  const int texture = sceneMaterials[sceneTriangles[triangle].w].emissiveTexture;
  return texture >= 0 ? sampleTexture(texture, triangleUv(triangle, barycentrics)).rgb : vec3(1.0);
}

// Coverage of a triangle with alpha, 0 … 1: a mask is all or nothing.
float triangleCoverage(uint triangle, vec2 barycentrics) {
  const Material m = sceneMaterials[sceneTriangles[triangle].w];
  float alpha = m.baseColor.a;
  if (m.baseColorTexture >= 0) alpha *= sampleTexture(m.baseColorTexture, triangleUv(triangle, barycentrics)).a;
  if ((m.flags & kMaterialMask) != 0u) return alpha >= m.alphaCutoff ? 1.0 : 0.0;
  return (m.flags & kMaterialBlend) != 0u ? clamp(alpha, 0.0, 1.0) : 1.0;
}
#endif

#endif
