// What travels along rays; shared by the interface and the hit shaders.
#ifndef WEIR_TRACE_TYPES
#define WEIR_TRACE_TYPES

#include "scene.glsl"

const uint kNoTriangle = 0xffffffffu;

struct Hit {
  uint triangle;  // kNoTriangle: nothing was hit
  uint instance;
  vec2 barycentrics;  // of vertices 1 and 2
};

struct HitPayload {
  uint triangle;
  uint instance;
  vec2 barycentrics;
  uint key;
};

// Whether a surface with alpha is there for a primary ray: a coin keyed by primitive and the ray's key (pixel and frame), so
// that both back ends and every driver's order of any-hit calls agree.
bool coversPixel(float coverage, uint triangle, uint key) {
  if (coverage >= 1.0) return true;
  if (coverage <= 0.0) return false;
  uint h = triangle * 0x9e3779b9u ^ key;
  h = (h ^ (h >> 16u)) * 0x7feb352du;
  h = (h ^ (h >> 15u)) * 0x846ca68bu;
  h ^= h >> 16u;
  return float(h >> 8u) * (1.0 / 16777216.0) < coverage;
}

#endif
