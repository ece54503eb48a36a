// Merging reservoirs of other surfaces into a pixel's own: the MIS weights of temporal and spatial reuse.
//   biased    m_i = c_i / C. Cheapest; darkens where the others' targets vanish.
//   pairwise  defensive pairwise MIS (Bitterli 2022; Lin et al. 2022, eq. 7.x): each neighbour is paired with the canonical sample,
//             m_j = (c_j/T) · B p̂_j(x_j) / (c_c p̂_c(x_j) + B p̂_j(x_j)),
//             m_c = c_c/T + Σ_j (c_j/T) · c_c p̂_c(x_c) / (c_c p̂_c(x_c) + B p̂_j(x_c)),    B = Σ_j c_j, T = B + c_c.
// With VISIBILITY_RAYS the p̂_j of the weights include the neighbour's visibility. A neighbour whose sample is null or whose target
// is zero adds nothing and keeps its confidence in every weight; which neighbours take part depends on surfaces alone.
//
// With PREVIOUS_DOMAIN the neighbour is a surface of the last frame: its target is evaluated with lights, geometry and shadows as they
// were then, or energy is lost and gained where something moved. A sample is a place on a light. Its W is per m², and belongs to the
// light as it was when the sample was drawn: where a triangle's area has changed since, W grows with it, and densities per m² of
// the old triangle are brought to those of the new one.
#ifndef WEIR_MERGE
#define WEIR_MERGE

#include "reservoir.glsl"

const int kBiased = 0, kPairwise = 1;

struct Merge {
  Surface surface;     // of the merging pixel
  Reservoir own;       // the canonical reservoir
  LightSample ownLight;
  float ownTarget;     // p̂_c(x_c)
  float others;        // B
  float ownMis;        // m_c so far (pairwise)
  Selection selection;
};

Merge beginMerge(Surface surface, Reservoir own, float others) {
  Merge m;
  m.surface = surface;
  m.own = own;
  m.others = others;
  m.ownTarget = 0.0;
  if (!isNull(own)) {
    m.ownLight = evaluateLight(lightOf(own), own.place, surface.position);
    m.ownTarget = targetFunction(surface, m.ownLight);
  }
  m.ownMis = own.confidence / (own.confidence + others);
  m.selection = noSelection();
  return m;
}

#if defined(PREVIOUS_DOMAIN) && defined(SCENE_ANIMATED)
LightSample lightThere(uint light, uint place, vec3 position) { return evaluateLight(scenePreviousLights[light], place, position); }
#ifdef CAN_TRACE
float visibilityThere(Surface neighbour, LightSample light) { return traceVisibilityPrevious(neighbour, light); }
#endif
// What a density per m² of the neighbour's light is per m² of the light here.
float measureThere(LightSample there, LightSample here) { return there.area / here.area; }
float weightHere(Reservoir r, LightSample here) {
  const float before = scenePreviousLights[lightOf(r)].area;  // 0: not a triangle
  return before > 0.0 ? r.weight * (here.area / before) : r.weight;
}
#else
LightSample lightThere(uint light, uint place, vec3 position) { return evaluateLight(light, place, position); }
#ifdef CAN_TRACE
float visibilityThere(Surface neighbour, LightSample light) { return traceVisibility(neighbour, light); }
#endif
float measureThere(LightSample there, LightSample here) { return 1.0; }
float weightHere(Reservoir r, LightSample here) { return r.weight; }
#endif

// p̂ of a sample at a neighbour's surface, with its visibility there where the weights ask for it.
float neighbourTarget(Surface neighbour, LightSample light, bool seen) {
  float target = targetFunction(neighbour, light);
#ifdef VISIBILITY_RAYS
  if (target > 0.0 && !seen) target *= visibilityThere(neighbour, light);
#endif
  return target;
}

void mergeNeighbour(inout Merge m, Surface neighbour, Reservoir r, float confidence, int mis, float u) {
  const float total = m.own.confidence + m.others;
  if (mis == kPairwise && m.ownTarget > 0.0) {
    const LightSample there = lightThere(lightOf(m.own), m.own.place, neighbour.position);
    const float own = m.own.confidence * m.ownTarget;
    const float theirs = m.others * neighbourTarget(neighbour, there, false) * measureThere(there, m.ownLight);
    m.ownMis += confidence / total * (own / (own + theirs));
  }
  if (isNull(r)) return;
  const LightSample here = evaluateLight(lightOf(r), r.place, m.surface.position);
  const float target = targetFunction(m.surface, here);
  if (!(target > 0.0)) return;
  float weight = confidence / total;
  if (mis == kPairwise) {
    const LightSample there = lightThere(lightOf(r), r.place, neighbour.position);
    const float theirs = m.others * neighbourTarget(neighbour, there, isSeen(r)) * measureThere(there, here);
    weight *= theirs / (m.own.confidence * target + theirs);
  }
  offer(m.selection, lightOf(r), r.place, target, weight * target * weightHere(r, here), false, u);
}

// Offers the canonical sample last; what survives is retested for visibility by the caller where the weights used it.
Reservoir endMerge(inout Merge m, int mis, float u) {
  if (m.ownTarget > 0.0) {
    const float weight = mis == kPairwise ? m.ownMis : m.own.confidence / (m.own.confidence + m.others);
    offer(m.selection, lightOf(m.own), m.own.place, m.ownTarget, weight * m.ownTarget * m.own.weight, isSeen(m.own), u);
  }
  return finish(m.selection, m.own.confidence + m.others);
}

// Whether two surfaces are alike enough to share samples. Depth is relative to the distance, so that scale doesn't matter.
bool similar(PackedSurface a, PackedSurface b, float depthThreshold, float cosine, float albedoThreshold) {
  if (abs(a.distance - b.distance) > depthThreshold * a.distance) return false;
  if (dot(surfaceNormal(a), surfaceNormal(b)) < cosine) return false;
  const vec3 albedo = abs(unpackAlbedo(a.diffuse) - unpackAlbedo(b.diffuse));
  return max(albedo.x, max(albedo.y, albedo.z)) <= albedoThreshold;
}

#endif
