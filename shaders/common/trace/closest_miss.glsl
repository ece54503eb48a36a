#include "../trace_types.glsl"

layout(location = 0) rayPayloadInEXT HitPayload payload;

void main() { payload.triangle = kNoTriangle; }
