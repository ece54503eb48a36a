// From the visibility buffer to surfaces: the point on the triangle by intersecting its plane with the pixel's ray.
#define LEVEL_FROM_DERIVATIVES 1
#include "gbuffer_common.glsl"

// The instance that owns a drawn triangle: the last whose first one isn't above it.
uint instanceOfDrawn(uint drawn) {
  uint low = 0u, high = sceneInstanceCount;
  while (high - low > 1u) {
    const uint middle = (low + high) / 2u;
    if (sceneInstances[middle].firstDrawn <= drawn) low = middle;
    else high = middle;
  }
  return low;
}

void run(uvec2 pixel) {
  const uvec2 jitter = frameJitter();
  const vec3 direction = cameraDirection(camera, vec2(pixel) + jitterPlace(jitter), frameSize);
  const uint drawn = imageLoad(scratch_drawn, ivec2(pixel)).x;
  if (drawn == kNoTriangle) {
    writePixel(pixel, Hit(kNoTriangle, 0u, vec2(0.0)), direction, jitter);
    return;
  }
  const uint instance = instanceOfDrawn(drawn);
  const uint triangle = sceneInstances[instance].firstTriangle + drawn - sceneInstances[instance].firstDrawn;
  const uvec4 t = sceneTriangles[triangle];
  const mat4x3 world = toWorld(sceneInstances[instance]);
  const vec3 p0 = world * vec4(vertexPosition(t.x), 1.0) - camera.origin.xyz;
  const vec3 e1 = world * vec4(vertexPosition(t.y), 1.0) - camera.origin.xyz - p0;
  const vec3 e2 = world * vec4(vertexPosition(t.z), 1.0) - camera.origin.xyz - p0;
  // Möller and Trumbore 1997, without the bounds: the rasteriser has decided.
  const vec3 h = cross(direction, e2);
  const float determinant = dot(e1, h);
  vec2 barycentrics = vec2(1.0 / 3.0);
  if (determinant != 0.0) {
    barycentrics = vec2(dot(-p0, h), dot(direction, cross(-p0, e1))) / determinant;
    // A pixel's centre may lie outside by the rasteriser's rounding.
    barycentrics = clamp(barycentrics, 0.0, 1.0);
    barycentrics /= max(1.0, barycentrics.x + barycentrics.y);
  }
  writePixel(pixel, Hit(triangle, instance, barycentrics), direction, jitter);
}
