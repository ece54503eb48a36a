// Reached only by rays that nothing ended; the sign says so (see trace.glsl).
#include "../trace_types.glsl"

layout(location = 1) rayPayloadInEXT float through;

void main() { through = -through; }
