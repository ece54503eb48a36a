// A direction by the specular lobe, with what the shaders say of it.
#include "random.glsl"
#include "surface_of.glsl"

void run(uvec2 pixel) {
  const uint index = pixel.y * frameWidth + pixel.x;
  const Surface s = surfaceOf(in_lobes[index]);
  Random random = randomFor(pixel, 0u);
  const vec3 l = sampleSpecular(s, next2(random));
  out_drawn[index] = Drawn(l.x, l.y, l.z, specularDensity(s, l));
}
