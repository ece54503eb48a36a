// Visibility between a surface and a point on a light.
#ifndef WEIR_VISIBILITY
#define WEIR_VISIBILITY

#include "mutants.glsl"
#include "lights.glsl"
#include "surface.glsl"
#include "trace.glsl"

#ifdef CAN_TRACE
// A device meets a triangle with an error that grows with the triangle, however close by the ray begins: it subtracts the origin from
// corners that may be far away. Which triangle a ray leaves or reaches isn't known here, so that the scene's largest one stands for all.
const float kIntersectionError = 4.0 / 8388608.0;  // of the largest length that takes part
float intersectionError() { return sceneLargest * kIntersectionError; }

// A point off the surface by `error`, to the side of `direction`; and a step back along the ray that found the surface, where nothing is
// in the way: in the very edge of two walls the normal alone would stay within the other wall's error.
vec3 offSurface(Surface s, vec3 direction, float error) {
  error += MUTANT(48, 0.01 * s.distance, 0.0);
  return s.position + (dot(s.geometricNormal, direction) < 0.0 ? -s.geometricNormal : s.geometricNormal + s.view) * error;
}

// The start of a ray that leaves a surface.
vec3 offsetOrigin(Surface s, vec3 direction) { return offSurface(s, direction, s.error + intersectionError()); }

// The segment from the light's point to the surface; either end is moved towards the other by its own error, so that neither surface
// blocks itself. Rays begin at the light because that is what many of them share: those of pixels around, and those that are sorted
// (ray_order.glsl), go through the same boxes from the start, and a light behind a wall is found to be so at once.
// `extent` is in units of `way`; nothing is left of a segment when it isn't positive.
struct ShadowSegment {
  vec3 origin, way;
  float extent;
};

ShadowSegment shadowSegment(Surface s, LightSample light) {
  // What lies near the far end is met with an error that grows with the way, too.
  const vec3 end = offSurface(s, light.direction, s.error + intersectionError() + kIntersectionError * distance(s.position, light.target));
  const vec3 largest = max(abs(light.target), abs(end));
  const float lightError = max(largest.x, max(largest.y, largest.z)) * (16.0 / 8388608.0) + intersectionError();
  ShadowSegment r;
  r.way = end - light.target;
  const float begin = lightError * inversesqrt(dot(r.way, r.way));
  r.origin = light.target + begin * r.way;
  r.extent = MUTANT(47, 0.5, 1.0) - begin;
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
