// Real rasterisation into a visibility buffer: the triangle of each pixel and nothing else, since fragment work is what is slow where
// raster hardware is thin. raster_resolve.glsl turns it into surfaces.
#include "gbuffer_jitter.glsl"
#include "scene.glsl"
#include "trace_types.glsl"

#ifdef STAGE_VERTEX
vec4 vertex(uint instance, uint triangle, uint corner) {
  const vec3 world = toWorld(sceneInstances[instance]) * vec4(vertexPosition(sceneTriangles[triangle][corner]), 1.0);
  const vec3 p = world - camera.origin.xyz;
  const float z = dot(p, camera.forward.xyz);
  const float x = dot(p, camera.right.xyz) / dot(camera.right.xyz, camera.right.xyz);
  const float y = dot(p, camera.up.xyz) / dot(camera.up.xyz, camera.up.xyz);
  // The rasteriser samples at the pixel's centre; moving the picture the other way is jitter.
  const vec2 shift = (jitterPlace(frameJitter()) - 0.5) / frameSize * 2.0;
  // Reversed depth without a far plane: near/z.
  return vec4(x - shift.x * z, -y - shift.y * z, sceneNear, z);
}
#endif

#ifdef STAGE_FRAGMENT
// False: not there (alpha).
bool fragment(uint triangle, vec2 barycentrics, uvec2 pixel) {
  const uint flags = sceneMaterials[sceneTriangles[triangle].w].flags;
  if ((flags & (kMaterialMask | kMaterialBlend)) == 0u) return true;
  return coversPixel(triangleCoverage(triangle, barycentrics), triangle, coverageKey(pixel));
}
#endif
