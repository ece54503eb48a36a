// Alpha for shadow rays: light that a surface lets through goes on.
#include "../trace_types.glsl"

layout(location = 1) rayPayloadInEXT float through;
hitAttributeEXT vec2 attributes;

void main() {
  const uint triangle = hitTriangle(gl_InstanceCustomIndexEXT, gl_GeometryIndexEXT, gl_PrimitiveID);
  through *= 1.0 - triangleCoverage(triangle, attributes);
  if (through > 0.0) ignoreIntersectionEXT;
}
