// Visibility between a surface and a point on a light.
#ifndef WEIR_VISIBILITY
#define WEIR_VISIBILITY

#include "lights.glsl"
#include "surface.glsl"
#include "trace.glsl"

#ifdef CAN_TRACE
// A ray's start, moved off the surface by its error, to the side that `direction` leaves it.
vec3 offsetOrigin(Surface s, vec3 direction) {
  return s.position + s.geometricNormal * (dot(s.geometricNormal, direction) < 0.0 ? -s.error : s.error);
}

// Transmittance of the segment from the surface to the light's point; either end is moved towards the other by its own error, so
// that neither surface blocks itself.
float traceVisibility(Surface s, LightSample light) {
  const vec3 origin = offsetOrigin(s, light.direction);
  const vec3 d = light.target - origin;
  const vec3 largest = max(abs(light.target), abs(origin));
  const float targetError = max(largest.x, max(largest.y, largest.z)) * (16.0 / 8388608.0);
  const float tMax = 1.0 - targetError * inversesqrt(dot(d, d));
  return tMax > 0.0 ? traceTransmittance(origin, d, tMax) : 1.0;
}
#endif

#endif
