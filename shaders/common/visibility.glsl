// Visibility between a surface and a point on a light.
#ifndef WEIR_VISIBILITY
#define WEIR_VISIBILITY

#include "mutants.glsl"
#include "lights.glsl"
#include "surface.glsl"
#include "trace.glsl"

#ifdef CAN_TRACE
// A device meets a triangle with an error that grows with the triangle, however close by the ray begins: it subtracts the origin from
// corners that may be far away. Which triangle the ray leaves isn't known here, so that the scene's largest one stands for all.
float intersectionError() { return sceneLargest * (4.0 / 8388608.0); }

// A ray's start, moved off the surface by its error, to the side that `direction` leaves it; and a step back along the ray that found
// the surface, where nothing is in the way: in the very edge of two walls the normal alone would stay within the other wall's error.
vec3 offsetOrigin(Surface s, vec3 direction) {
  const float error = s.error + intersectionError() + MUTANT(48, 0.01 * s.distance, 0.0);
  return s.position + (dot(s.geometricNormal, direction) < 0.0 ? -s.geometricNormal : s.geometricNormal + s.view) * error;
}

// The segment from the surface to the light's point; either end is moved towards the other by its own error, so that neither
// surface blocks itself. `extent` is in units of `way`; nothing is left of a segment when it isn't positive.
struct ShadowSegment {
  vec3 origin, way;
  float extent;
};

ShadowSegment shadowSegment(Surface s, LightSample light) {
  ShadowSegment r;
  r.origin = offsetOrigin(s, light.direction);
  r.way = light.target - r.origin;
  const vec3 largest = max(abs(light.target), abs(r.origin));
  const float targetError = max(largest.x, max(largest.y, largest.z)) * (16.0 / 8388608.0) + intersectionError();
  r.extent = MUTANT(47, 0.5, 1.0) - targetError * inversesqrt(dot(r.way, r.way));
  return r;
}

// Transmittance of that segment.
float traceVisibility(Surface s, LightSample light) {
  const ShadowSegment r = shadowSegment(s, light);
  return r.extent > 0.0 ? traceTransmittance(r.origin, r.way, r.extent) : 1.0;
}

#ifdef NEED_PREVIOUS_ACCELERATION
// The same through last frame's scene; surface and light are then last frame's too.
float traceVisibilityPrevious(Surface s, LightSample light) {
  const ShadowSegment r = shadowSegment(s, light);
  return r.extent > 0.0 ? traceTransmittancePrevious(r.origin, r.way, r.extent) : 1.0;
}
#endif
#endif

#endif
