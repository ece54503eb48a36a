// Value valueAt(uvec2 pixel): what a port says at a pixel. READING is how its bytes are read.
#if READING == 0
#include "read_image.glsl"
#elif READING == 1
#include "read_integers.glsl"
#else
layout(std430, set = 0, binding = 0) readonly buffer Source { uint words[]; };

// Where the pixel's element starts, in words; false beyond the last one.
bool elementAt(uvec2 pixel, out uint first) {
  const uint index = (pixel.y * settings.extent.x + pixel.x) * settings.perPixel + settings.element;
  first = index * settings.stride;
  return index < settings.elements;
}

#if READING == 2
#include "read_words.glsl"
#elif READING == 3
#include "read_surface.glsl"
#else
#include "read_reservoir.glsl"
#endif
#endif
