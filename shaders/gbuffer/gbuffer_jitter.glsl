#ifndef WEIR_GBUFFER_JITTER
#define WEIR_GBUFFER_JITTER

#include "random.glsl"

// The sample's place in every pixel of this frame, 0 … 254 a side; 127: the centre. The same for all pixels, so that a
// rasteriser can follow.
uvec2 frameJitter() {
  if (!param_jitter) return uvec2(127u);
  const uvec4 bits = pcg4d(uvec4(0u, frameIndex, frameSeed, launchStream));
  return (bits.xy >> 8u) % 255u;
}

// The sample's place in pixels from the pixel's corner.
vec2 jitterPlace(uvec2 jitter) { return (vec2(jitter) + 0.5) / 255.0; }

// Key of a pixel's coins for surfaces with alpha.
uint coverageKey(uvec2 pixel) { return pcg4d(uvec4(pixel, frameIndex, frameSeed)).x; }

#endif
