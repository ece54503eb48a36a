// What a surface reflects of light from all around: a square grid of random numbers, one column a pixel, sent through the specular lobe
// and through the cosine, and weighed by the balance heuristic. Rows are shifted by the golden ratio, so that the edge where light falls
// below the surface doesn't run along the grid.
#include "surface_of.glsl"

float weighed(Surface s, vec3 l, float cosineShare) {
  const float density = specularDensity(s, l) + cosineShare * max(dot(s.normal, l), 0.0) / kPi;
  return density > 0.0 ? bsdfCos(s, l).x / density : 0.0;
}

void run(uvec2 pixel) {
  const uint index = pixel.y * frameWidth + pixel.x;
  const Lobe lobe = in_lobes[index];
  const Surface s = surfaceOf(lobe);
  const bool diffuse = lobe.diffuse > 0.0;  // the lobe alone is smoother where there is nothing else
  const mat3 world = basisAround(s.normal);
  float sum = 0.0;
  for (uint i = 0u; i < frameWidth; ++i) {
    const vec2 u = vec2(float(pixel.x) + fract(float(i) * 0.618034), float(i) + 0.5) / float(frameWidth);
    sum += weighed(s, sampleSpecular(s, u), diffuse ? 1.0 : 0.0);
    const float r = sqrt(u.x), angle = 2.0 * kPi * u.y;
    if (diffuse) sum += weighed(s, world * vec3(r * cos(angle), r * sin(angle), sqrt(1.0 - u.x)), 1.0);
  }
  out_albedo[index] = Albedo(sum / float(frameWidth));
}
