// Both questions of the tracing interface, asked for the test's own segments.
#include "trace.glsl"

void run(uvec2 pixel) {
  const uint index = pixel.y * frameWidth + pixel.x;
  const Segment s = in_segments[index];
  const vec3 origin = vec3(s.ox, s.oy, s.oz), direction = vec3(s.dx, s.dy, s.dz);
  const Hit hit = traceClosest(origin, direction, s.tMax, s.key, kEverySide);
  const Hit seen = traceClosest(origin, direction, s.tMax, s.key, kCameraSides);
  const float through = traceTransmittance(origin, direction, s.tMax);
  out_found[index] = Found(hit.triangle, hit.instance, hit.barycentrics.x, hit.barycentrics.y, through, seen.triangle);
}
