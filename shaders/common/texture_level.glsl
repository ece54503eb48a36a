// Textures as a camera's pixel sees them: at the level whose texels are as large as what the pixel covers (SCENE_MIPMAPS), else at
// level 0. Two ways to that level:
//   ray cones          one cone a pixel, as wide as the pixel; Akenine-Möller et al. 2021, "Improved Shader and Texture Level of Detail
//                      Using Ray Cones", JCGT 10(1): isotropic, by the mean density of texels on the triangle
//   derivatives        (LEVEL_FROM_DERIVATIVES) of the barycentrics from pixel to pixel, exact, as a rasteriser's: the area of the pixel in
//                      the texture, made longer by the tilt of the surface
// Both are the same number up to the curvature of a pixel's edges: a pixel's area in the texture is its solid angle times distance
// squared over |n·d|, times the density of texels. Neither sees along which axis a triangle stretches its texture.
#ifndef WEIR_TEXTURE_LEVEL
#define WEIR_TEXTURE_LEVEL

#include "scene.glsl"
#include "trace_types.glsl"

#ifdef SCENE_MIPMAPS

// The world positions of a triangle's corners.
struct Corners {
  vec3 p0, p1, p2;
};

#ifdef LEVEL_FROM_DERIVATIVES
// Change of the barycentrics of vertices 1 and 2 from a pixel to the next, along the row and along the column.
struct Footprint {
  vec2 perX, perY;
  float tilt;  // log2 of how much longer than wide a cone is on the triangle
};

// Barycentrics are ratios of functions that are linear in the ray's direction (Möller and Trumbore 1997), and so is the direction in
// the pixel when its length along the camera's axis is kept.
Footprint footprintOf(Corners c, Hit hit, vec3 origin, vec3 direction) {
  const vec3 s = origin - c.p0, e1 = c.p1 - c.p0, e2 = c.p2 - c.p0;
  const vec3 below = cross(e2, e1), above1 = cross(e2, s), above2 = cross(s, e1);
  const vec3 dx = camera.right.xyz * (2.0 / float(frameWidth)), dy = camera.up.xyz * (-2.0 / float(frameHeight));
  const float determinant = dot(direction, below) / dot(direction, camera.forward.xyz);
  Footprint f;
  f.perX = (vec2(dot(dx, above1), dot(dx, above2)) - hit.barycentrics * dot(dx, below)) / determinant;
  f.perY = (vec2(dot(dy, above1), dot(dy, above2)) - hit.barycentrics * dot(dy, below)) / determinant;
  f.tilt = -log2(abs(dot(direction, below)) / length(below));
  return f;
}

float levelOf(Footprint f, int texture, vec2 edge1, vec2 edge2) {
  const vec2 size = vec2(textureSize(sceneTextures[nonuniformEXT(texture)], 0));
  const vec2 a = edgeIn(texture, edge1) * size, b = edgeIn(texture, edge2) * size;
  const vec2 x = f.perX.x * a + f.perX.y * b, y = f.perY.x * a + f.perY.y * b;
  const float area = abs(x.x * y.y - x.y * y.x);
  return area > 0.0 ? 0.5 * (log2(area) + f.tilt) : 0.0;
}
#else
// log2 of the cone's length on the triangle, in units of the square root of twice its area.
struct Footprint {
  float level;
};

Footprint footprintOf(Corners c, Hit hit, vec3 origin, vec3 direction) {
  const vec3 normal = cross(c.p1 - c.p0, c.p2 - c.p0);
  const float distance = dot(normal, c.p0 - origin) / dot(normal, direction);
  // The cone's angle is the root of the pixel's solid angle, which falls off with the cube of the cosine.
  const float cosine = dot(direction, camera.forward.xyz);
  const float pixel = 4.0 * length(camera.right.xyz) * length(camera.up.xyz) / float(frameWidth * frameHeight);
  const float width = distance * sqrt(pixel * cosine * cosine * cosine);
  const float twice = length(normal);
  return Footprint(log2(width * twice / abs(dot(normal, direction))) - 0.5 * log2(twice));
}

float levelOf(Footprint f, int texture, vec2 edge1, vec2 edge2) {
  const float twice = abs(edge1.x * edge2.y - edge1.y * edge2.x);
  return twice > 0.0 ? f.level + 0.5 * log2(twice) + sceneTextureUses[texture].texelLevel : 0.0;
}
#endif

// A place on a triangle for lookups in its textures.
struct Lookup {
  Coordinates at, edge1, edge2;
  Footprint footprint;
  bool base;  // level 0 of all textures
};

Lookup lookupAt(uvec4 triangle, Corners corners, Hit hit, vec3 origin, vec3 direction) {
  Lookup l;
  l.base = false;
  l.at = coordinatesAt(triangle, hit.barycentrics);
  l.edge1.set0 = sceneVertices[triangle.y].uv - sceneVertices[triangle.x].uv;
  l.edge2.set0 = sceneVertices[triangle.z].uv - sceneVertices[triangle.x].uv;
#ifdef SCENE_UV_SETS
  l.edge1.set1 = sceneUvs1[triangle.y] - sceneUvs1[triangle.x];
  l.edge2.set1 = sceneUvs1[triangle.z] - sceneUvs1[triangle.x];
#endif
  l.footprint = footprintOf(corners, hit, origin, direction);
  return l;
}

// Level 0, however large the texels are.
Lookup baseLookupAt(uvec4 triangle, Hit hit) {
  Lookup l;
  l.at = coordinatesAt(triangle, hit.barycentrics);
  l.edge1 = l.edge2 = l.at;
  l.base = true;
  return l;
}

vec4 look(int texture, Lookup l) {
  if (l.base) return sampleTexture(texture, l.at);
  const float level = levelOf(l.footprint, texture, setOf(texture, l.edge1), setOf(texture, l.edge2));
  return textureLod(sceneTextures[nonuniformEXT(texture)], placeIn(texture, l.at), level);
}

#else

struct Lookup {
  Coordinates at;
};

vec4 look(int texture, Lookup l) { return sampleTexture(texture, l.at); }

#endif

#endif
