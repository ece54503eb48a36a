// Alpha for primary rays.
#include "../trace_types.glsl"

layout(location = 0) rayPayloadInEXT HitPayload payload;
hitAttributeEXT vec2 attributes;

void main() {
  const uint triangle = hitTriangle(gl_InstanceCustomIndexEXT, gl_GeometryIndexEXT, gl_PrimitiveID);
  if (!coversPixel(triangleCoverage(triangle, attributes), triangle, payload.key)) ignoreIntersectionEXT;
}
