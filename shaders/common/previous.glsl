// Where things were in the last frame. In a scene that nothing moves the names mean this frame's data, and cost nothing.
#ifndef WEIR_PREVIOUS
#define WEIR_PREVIOUS

#include "trace_types.glsl"

// Where the point of a hit was in the last frame's world; `position` is where it is now.
vec3 previousPosition(Hit hit, vec3 position) {
#ifdef SCENE_ANIMATED
  const uvec4 t = sceneTriangles[hit.triangle];
  const vec3 b = vec3(1.0 - hit.barycentrics.x - hit.barycentrics.y, hit.barycentrics);
  vec3 stored = vec3(0.0);
  for (int k = 0; k < 3; ++k) {
    const uint v = 3u * t[k];
    stored += b[k] * vec3(scenePreviousPositions[v], scenePreviousPositions[v + 1u], scenePreviousPositions[v + 2u]);
  }
  return toWorld(scenePreviousInstances[hit.instance]) * vec4(stored, 1.0);
#else
  return position;
#endif
}

#endif
