// Images of 32-bit integers.
layout(set = 0, binding = 0) readonly uniform uimage2D source;

Value valueAt(uvec2 pixel) { return wordOf(imageLoad(source, ivec2(pixel)).r); }
