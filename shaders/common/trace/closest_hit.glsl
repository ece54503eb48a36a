// Nearest hit: says which triangle and where on it; whoever traced reads the rest himself.
#include "../trace_types.glsl"

layout(location = 0) rayPayloadInEXT HitPayload payload;
hitAttributeEXT vec2 attributes;

void main() {
  payload.instance = gl_InstanceCustomIndexEXT;
  payload.triangle = hitTriangle(payload.instance, gl_GeometryIndexEXT, gl_PrimitiveID);
  payload.barycentrics = attributes;
}
