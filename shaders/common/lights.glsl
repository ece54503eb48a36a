// Lights: one table of triangles and punctual lights (framework/scene/lights.h). A sample is a light and a point on it
// (light_place.glsl).
#ifndef WEIR_LIGHTS
#define WEIR_LIGHTS

#include "mutants.glsl"
#include "light_place.glsl"
#include "random_bits.glsl"
#include "scene.glsl"
#include "surface.glsl"
#ifdef SCENE_ENVIRONMENT
#include "environment.glsl"
#endif

const uint kPoint = 0u, kSpot = 1u, kDirectional = 2u, kTriangle = 3u, kEnvironment = 4u;
const uint kKindMask = 0xffu, kLightDoubleSided = 1u << 8, kLightTextured = 1u << 9, kLightTurned = 1u << 10,
           kLightAlpha = 1u << 11;
const uint kNoLight = 0xffffffffu;

// A point on a light as seen from a surface.
struct LightSample {
  vec3 direction;  // unit, towards the light
  vec3 radiance;   // what arrives, times the geometry term: per area for triangles, per steradian for the environment, per light
                   // for the rest
  vec3 target;     // the point; for directional lights and the environment one far beyond the scene
  float area;      // m², 1 for punctual lights: the sample's density is pdf of the light / area. 1 for the environment, whose
                   // density its table says
};

uint lightCount() { return uint(sceneLightCount); }

// Picks a light by power from a uniform number each for the cell and within it.
uint pickLight(uint bits, float v) {
  const uint cell = scaleBits(bits, lightCount());
  return v < sceneAlias[cell].threshold ? cell : sceneAlias[cell].alias;
}

// Picks a light by power with probability 1 - `uniformShare`, else any: a dim light close by is found in time, and no light's
// density is less than uniformShare / n. mixedPdf() is the probability of what came out.
uint pickMixed(uvec2 bits, float uniformShare) {
  const float u = unitFromBits(bits.y), byPower = 1.0 - uniformShare;
  return u < byPower ? pickLight(bits.x, u / byPower) : scaleBits(bits.x, lightCount());
}
float mixedPdf(Light light, float uniformShare) {
  return MUTANT(43, light.pdf, mix(light.pdf, 1.0 / float(lightCount()), uniformShare));
}

// The light that a triangle is, for rays that hit one; kNoLight: none.
uint lightOfTriangle(uint triangle) {
#ifdef SCENE_TRIANGLE_LIGHTS
  const uint entry = triangle - sceneLitTriangles.first;  // wraps round below the first
  if (entry < sceneLitTriangles.count) return sceneLitTriangles.lights[entry];
#endif
  return kNoLight;
}

// From the barycentrics of a light to those of its triangle, and back.
vec2 turnedBarycentrics(Light light, vec2 barycentrics) {
#ifdef SCENE_ANIMATED
  // Corners 1 and 2 of a triangle that its transform mirrors have changed places, so that it faces the way that it emits.
  if ((light.kind & kLightTurned) != 0u) return barycentrics.yx;
#endif
  return barycentrics;
}

// Radiance of a triangle at a place on it, nit: what a ray that reaches the place finds there in the mean, which is less where alpha
// lets it through.
vec3 emittedRadiance(Light light, vec2 barycentrics) {
  vec3 radiance = light.radiance;
#if defined(SCENE_TEXTURED_LIGHTS) || defined(SCENE_ALPHA_LIGHTS)
  const vec2 at = turnedBarycentrics(light, barycentrics);
#endif
#ifdef SCENE_TEXTURED_LIGHTS
  if ((light.kind & kLightTextured) != 0u) radiance *= emissionTexture(light.triangle, at);
#endif
#ifdef SCENE_ALPHA_LIGHTS
  if ((light.kind & kLightAlpha) != 0u) radiance *= triangleCoverage(light.triangle, at);
#endif
  return radiance;
}

LightSample evaluateTriangle(Light light, vec2 barycentrics, vec3 position) {
  LightSample s;
  const vec3 normalArea = cross(light.a, light.b);  // length = 2 · area
  s.target = light.position + barycentrics.x * light.a + barycentrics.y * light.b;
  s.area = light.area;
  const vec3 d = s.target - position;
  const float d2 = dot(d, d);
  s.direction = d * inversesqrt(d2);
  float cosine = -dot(normalArea, s.direction) / (2.0 * light.area);
  if ((light.kind & kLightDoubleSided) != 0u) cosine = abs(cosine);
  if (!(cosine > 0.0) || !(d2 > 0.0)) {
    s.radiance = vec3(0.0);
    return s;
  }
  s.radiance = emittedRadiance(light, barycentrics) * (cosine / d2);
  return s;
}

// A point light without a range.
LightSample evaluatePoint(vec3 at, vec3 intensity, vec3 position) {
  LightSample s;
  const vec3 d = at - position;
  const float d2 = dot(d, d);
  s.target = at;
  s.area = 1.0;
  s.direction = d * inversesqrt(d2);
  s.radiance = d2 > 0.0 ? intensity / d2 : vec3(0.0);
  return s;
}

LightSample evaluatePunctual(Light light, vec3 position) {
  LightSample s;
  s.area = 1.0;
#ifdef SCENE_SHAPED_LIGHTS
  const uint kind = light.kind & kKindMask;
  if (kind == kDirectional) {
    s.direction = -light.a;
    s.target = position + s.direction * sceneDiameter;
    s.radiance = light.radiance;
    return s;
  }
#endif
  const vec3 d = light.position - position;
  const float d2 = dot(d, d);
  s.target = light.position;
  s.direction = d * inversesqrt(d2);
  float attenuation = 1.0 / d2;
#ifdef SCENE_SHAPED_LIGHTS
  // KHR_lights_punctual's recommended window: 1 at the light, 0 at its range.
  if (light.b.z > 0.0) {
    const float q = d2 / (light.b.z * light.b.z);
    attenuation *= clamp(1.0 - MUTANT(42, q, q * q), 0.0, 1.0);
  }
  if (kind == kSpot) {
    const float t = clamp((dot(-s.direction, light.a) - light.b.y) * light.b.x, 0.0, 1.0);
    attenuation *= MUTANT(41, t, t * t);
  }
#endif
  s.radiance = d2 > 0.0 ? light.radiance * attenuation : vec3(0.0);
  return s;
}

#ifdef SCENE_ENVIRONMENT
LightSample environmentSample(vec3 direction, vec3 radiance, vec3 position) {
  return LightSample(direction, radiance, position + direction * sceneDiameter, 1.0);
}

// The same place is the same direction from everywhere.
LightSample evaluateEnvironment(uint place, vec3 position) {
  const EnvironmentPoint p = environmentPoint(place);
  return environmentSample(p.direction, environmentAt(p.uv), position);
}
#endif

LightSample evaluateLight(Light light, uint place, vec3 position) {
#ifdef SCENE_TRIANGLE_LIGHTS
  if ((light.kind & kKindMask) == kTriangle) return evaluateTriangle(light, placeOnTriangle(place), position);
#endif
#ifdef SCENE_ENVIRONMENT
  if ((light.kind & kKindMask) == kEnvironment) return evaluateEnvironment(place, position);
#endif
  return evaluatePunctual(light, position);
}

LightSample evaluateLight(uint index, uint place, vec3 position) { return evaluateLight(sceneLights[index], place, position); }

// Barycentrics of where a ray from `position` meets a triangle's plane.
vec2 barycentricsAlong(Light light, vec3 position, vec3 direction) {
  const vec3 normal = cross(light.a, light.b);
  const vec3 toCorner = light.position - position;
  const vec3 d = direction * (dot(normal, toCorner) / dot(normal, direction)) - toCorner;
  return vec2(dot(normal, cross(d, light.b)), dot(normal, cross(light.a, d))) / dot(normal, normal);
}

// Whether a ray from `position` meets the triangle itself, whichever side; `barycentrics` of where it does.
bool meetsTriangle(Light light, vec3 position, vec3 direction, out vec2 barycentrics) {
  const vec3 normal = cross(light.a, light.b);
  barycentrics = barycentricsAlong(light, position, direction);
  return dot(normal, light.position - position) * dot(normal, direction) > 0.0 &&
         all(greaterThanEqual(barycentrics, vec2(0.0))) && barycentrics.x + barycentrics.y <= 1.0;
}

// The place whose placeOnTriangle() lies at these barycentrics, to within its 16 bits a side.
uint placeAt(vec2 barycentrics) { return packPlace(clamp(barycentrics, 0.0, 65535.5 / 65536.0)); }

#endif
