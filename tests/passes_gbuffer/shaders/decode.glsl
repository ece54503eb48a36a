// The scene's first texture, a texel a pixel.
#include "scene.glsl"

void run(uvec2 pixel) {
  const vec2 uv = (vec2(pixel) + 0.5) / frameSize;
  imageStore(out_color, ivec2(pixel), textureLod(sceneTextures[0], uv, 0.0));
}
