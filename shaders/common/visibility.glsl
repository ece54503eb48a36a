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

// The segment between the light's point and the surface; either end is moved towards the other by its own error, so that neither surface
// blocks itself. Rays begin at the light because that is what many of them share: those of pixels around, and those that are sorted
// (ray_order.glsl), go through the same boxes from the start. Only, the error at the far end grows with the way, and where
// it would be much more than the surface's own, from lights far away, shadows of what is close would be lost: those rays begin at the
// surface.
// `extent` is in units of `way`; nothing is left of a segment when it isn't positive.
struct ShadowSegment {
  vec3 origin, way;
  float extent;
};

ShadowSegment shadowSegment(Surface s, LightSample light) {
  const float nearError = s.error + intersectionError(), farError = kIntersectionError * distance(s.position, light.target);
  const bool fromLight = farError <= 16.0 * nearError;
  const vec3 atSurface = offSurface(s, light.direction, nearError + (fromLight ? farError : 0.0));
  const vec3 largest = max(abs(light.target), abs(atSurface));
  const float lightError = max(largest.x, max(largest.y, largest.z)) * (16.0 / 8388608.0) + intersectionError();
  const vec3 whole = atSurface - light.target;
  const float begin = lightError * inversesqrt(dot(whole, whole));
  ShadowSegment r;
  r.origin = fromLight ? light.target + begin * whole : atSurface;
  r.way = fromLight ? whole : -whole;
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
