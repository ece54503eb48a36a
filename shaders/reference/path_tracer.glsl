// Path tracing from the camera's surfaces (Kajiya 1986). At every vertex one light sample with its shadow ray, and one direction by the
// BSDF with the ray that finds the next vertex; light that both can find is weighed by the balance heuristic with the densities of
// exactly what is drawn (Veach 1997). Nothing is reused, clamped or cached.
#include "mutants.glsl"
#include "random.glsl"
#include "light_sample.glsl"
#include "visibility.glsl"
#include "hit_surface.glsl"

const int kBoth = 0, kByLights = 1, kByBsdf = 2;
const float kInfinity = 3.0e38;

// Reflections of lights are found by the BSDF's rays where both ways are taken, else along the specular lobe.
TriangleWays triangleWays() { return TriangleWays(true, param_lightSampling == kByLights ? 0.25 : 0.0); }

// Direct light by one light sample: f L V over the density of what was drawn and, for light that the BSDF's ray finds too, of that.
vec3 lightAt(Surface surface, inout Random random) {
  if (lightCount() == 0u) return vec3(0.0);
  const uvec4 choice = nextBits4(random), bits = nextBits4(random);
  const Light light = sceneLights[pickMixed(choice.xy, param_uniformShare)];
  const uint kind = light.kind & kKindMask;
  const bool isArea = kind == kTriangle || kind == kEnvironment;
  if (isArea && param_lightSampling == kByBsdf) return vec3(0.0);
  const Candidate c = drawOnLight(light, bits, surface, triangleWays());
  if (!(c.spread > 0.0) || c.light.radiance == vec3(0.0)) return vec3(0.0);
  const vec3 f = bsdfCos(surface, c.light.direction) * c.light.radiance;
  if (f == vec3(0.0)) return vec3(0.0);
  float density = mixedPdf(light, param_uniformShare) / c.spread;
  if (isArea && param_lightSampling == kBoth) {
    const float measure = kind == kTriangle ? steradianPerArea(light, c.light, surface.position) : 1.0;
    density += MUTANT(60, 0.0, bsdfDensity(surface, c.light.direction) * measure);
  }
  return f * (traceVisibility(surface, c.light) / density);
}

// Weight of light that a direction of this density by the BSDF has found and light sampling finds with the other one.
float weightOf(float byBsdf, float byLights) {
  if (param_lightSampling == kByLights) return 0.0;
  return param_lightSampling == kByBsdf ? 1.0 : byBsdf / (byBsdf + byLights);
}

// Light that a path brings to its first vertex's viewer, without what that vertex emits itself.
vec3 tracePath(Surface surface, inout Random random) {
  vec3 sum = vec3(0.0), throughput = vec3(1.0);
  for (int bounce = 0;; ++bounce) {
    sum += throughput * lightAt(surface, random);
    const bool last = MUTANT(64, bounce + 1, bounce) == param_maxBounces;
    if (last && param_lightSampling == kByLights) break;

    const vec3 direction = sampleBsdf(surface, next4(random).xyz);
    const vec3 f = bsdfCos(surface, direction);
    const float density = bsdfDensity(surface, direction);
    if (f == vec3(0.0) || !(density > 0.0)) break;
    throughput *= f / density;
    // Each ray has coins of its own for surfaces with alpha.
    const uvec4 coins = nextBits4(random);
    const Hit hit = traceClosest(offsetOrigin(surface, direction), direction, kInfinity, coins.x, kEverySide);
    if (hit.triangle == kNoTriangle) {
#ifdef SCENE_ENVIRONMENT
      sum += throughput * environmentRadiance(direction) * weightOf(density, missDensity(direction, param_uniformShare));
#endif
      break;
    }
    const HitSurface found = surfaceAt(hit, surface.position, direction, kBaseTexels);
#ifdef SCENE_UNLIT
    // Unlit surfaces show themselves to the camera alone: no light is picked on them, and they reflect none.
    if ((sceneMaterials[sceneTriangles[hit.triangle].w].flags & kMaterialUnlit) != 0u) break;
#endif
    if (found.emission != vec3(0.0)) {
      float byLights = 0.0;
      const uint index = lightOfTriangle(hit.triangle);
      if (index != kNoLight) {
        const Light light = sceneLights[index];
        byLights = hitDensity(light, turnedBarycentrics(light, hit.barycentrics), surface, triangleWays(), param_uniformShare);
      }
      sum += throughput * found.emission * MUTANT(65, 1.0, weightOf(density, byLights));
    }
    if (last) break;

    // Russian roulette (Arvo and Kirk 1990): whoever survives stands for those who don't, whatever the probability.
    if (bounce >= param_rouletteStart) {
      const float survival = min(max(throughput.r, max(throughput.g, throughput.b)), 1.0);
      if (!(unitFromBits(coins.y) < survival)) break;
      throughput /= MUTANT(61, 1.0, survival);
    }
    surface = surfaceFrom(found, direction);
  }
  return sum;
}

void run(uvec2 pixel) {
  const uint index = pixel.y * frameWidth + pixel.x;
  vec3 color = imageLoad(in_emission, ivec2(pixel)).rgb;
  const PackedSurface packed = in_surface[index];
  if (isSurface(packed)) {
    const Surface surface = unpackSurface(packed, pixel, camera, frameSize);
    Random random = randomFor(pixel, 0u);
    vec3 sum = vec3(0.0);
    for (int i = 0; i < param_samples; ++i) sum += tracePath(surface, random);
    color += sum / float(param_samples);
  }
  imageStore(out_color, ivec2(pixel), vec4(color, 1.0));
}
