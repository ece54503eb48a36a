// The scene's square, drawn over the whole picture.
#include "scene.glsl"

#ifdef STAGE_VERTEX
vec4 vertex(uint instance, uint triangle, uint corner) {
  return vec4(vertexPosition(sceneTriangles[triangle][corner]).xy, 0.5, 1.0);
}
#endif

#ifdef STAGE_FRAGMENT
bool fragment(uint triangle, vec2 barycentrics, uvec2 pixel) { return true; }
#endif
