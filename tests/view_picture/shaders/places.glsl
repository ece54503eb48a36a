// Places on lights as lights.glsl unpacks them.
#include "light_place.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, set = 0, binding = 0) readonly buffer Places { uint places[]; };
layout(std430, set = 0, binding = 1) writeonly buffer Unpacked { vec4 unpacked[]; };
void main() {
  const uint i = gl_GlobalInvocationID.y * 8u + gl_GlobalInvocationID.x;
  unpacked[i] = vec4(unpackPlace(places[i]), placeOnTriangle(places[i]));
}
