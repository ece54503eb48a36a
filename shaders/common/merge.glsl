// Merging reservoirs of other surfaces into a pixel's own: what temporal and spatial reuse share. docs/estimators.md has the derivation.
// The pass says who its neighbours are; one of the files merge_*.glsl, by a define of the host, gives
//   Reservoir merge(Surface surface, Reservoir own)
//   MIS_BIASED    m_i = c_i / C: by confidence alone
//   MIS_Z         m_i = c_i / Σ c_j over the domains j that contain the sample
//   MIS_BALANCE   m_i = c_i p̂_i / Σ_j c_j p̂_j
//   MIS_PAIRWISE  defensive pairwise
// With VISIBILITY_RAYS the neighbours' targets include their visibility, and what survives is tested at its new pixel. A neighbour whose
// sample is null or whose target is zero adds nothing and keeps its confidence in every weight; which neighbours take part depends on
// surfaces alone.
//
// With PREVIOUS_DOMAIN the neighbours are surfaces of the last frame: their targets are evaluated with lights, geometry and shadows as
// they were then, or energy is lost and gained where something moved. A sample is a place on a light. Its W is per m², and belongs to
// the light as it was when the sample was drawn: where a triangle's area has changed since, W grows with it, and densities per m² of
// the old triangle are brought to those of the new one.
#ifndef WEIR_MERGE
#define WEIR_MERGE

#include "mutants.glsl"
#include "reservoir.glsl"

// Defined by the pass. A neighbour's reservoir has the confidence with which it counts here.
uint neighbourCount();
Reservoir neighbourReservoir(uint i);
Surface neighbourSurface(uint i);
bool isThisSurface(uint i);  // that neighbour is the merging surface itself, seen as it is now: what is known there is known here
float nextChance();  // uniform in [0, 1), a new one each time

// Σ m_i f(y_i) W_i of all that were merged, without their visibility: what is chosen from them is one of its terms, blown up to stand for
// all. Shade keeps the sum where the chosen one is seen.
vec3 mergedLight;

// Offers a sample with its part m of the MIS weights and its contribution weight W here.
bool offerMerged(inout Selection selection, Reservoir r, vec3 f, float m, float W, bool seen, float chance);

#if defined(PREVIOUS_DOMAIN) && defined(SCENE_ANIMATED)
LightSample lightThere(uint light, uint place, vec3 position) { 
  if (MUTANT(2, true, false)) return evaluateLight(light, place, position);
  return evaluateLight(scenePreviousLights[light], place, position);
}
#ifdef CAN_TRACE
float visibilityThere(Surface neighbour, LightSample light) {
  return MUTANT(3, traceVisibility(neighbour, light), traceVisibilityPrevious(neighbour, light));
}
#endif
// What a density per m² of the neighbour's light is per m² of the light here.
float measureThere(LightSample there, LightSample here) { return there.area / here.area; }
float weightHere(Reservoir r, LightSample here) {
  const float before = scenePreviousLights[lightOf(r)].area;  // 0: not a triangle
  return before > 0.0 ? r.weight * MUTANT(5, 1.0, here.area / before) : r.weight;
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
  if (target > 0.0 && !seen) target *= MUTANT(6, 1.0, visibilityThere(neighbour, light));
#endif
  return target;
}

// Whose neighbours are this pixel's own past, hands on what is known of their visibility from here as a hint.
#ifdef PREVIOUS_DOMAIN
const bool hintsStay = true;
#else
const bool hintsStay = false;
#endif

bool offerMerged(inout Selection selection, Reservoir r, vec3 f, float m, float W, bool seen, float chance) {
  const float target = luminance(f), weight = m * target * W;
  if (weight > 0.0 && !isinf(weight)) mergedLight += f * (m * W);
  if (!offer(selection, lightOf(r), r.place, target, weight, seen, chance)) return false;
  selection.hidden = hintsStay && wasHidden(r);
  return true;
}

// f W of what was chosen, which stands for all.
vec3 standing(Reservoir r, Surface surface) {
  return isNull(r) ? vec3(0.0) : unshadowed(surface, evaluateLight(lightOf(r), r.place, surface.position)) * r.weight;
}

// What was chosen, tested at its new pixel where the weights count on that.
Reservoir finishMerge(Selection selection, Surface surface, float confidence, Reservoir own) {
  Reservoir merged = finish(selection, confidence);
#ifdef wanted_out_light
#ifdef MIS_Z
  const bool alone = true;  // the others' Z are not known
#else
  // Where nothing of its own was seen, others' samples are likely hidden, too.
  const bool alone = isNull(own) || wasHidden(own);
#endif
  if (alone) mergedLight = standing(merged, surface);
#endif
#ifdef VISIBILITY_RAYS
  const Reservoir chosen = merged;
  if (MUTANT(7, false, true)) testVisibility(merged, surface);
#ifdef wanted_out_light
  if (MUTANT(71, false, isNull(merged))) mergedLight -= standing(chosen, surface);
#endif
#endif
  return merged;
}

#if defined(MIS_BIASED)
#include "merge_biased.glsl"
#elif defined(MIS_Z)
#include "merge_z.glsl"
#elif defined(MIS_BALANCE)
#include "merge_balance.glsl"
#else
#include "merge_pairwise.glsl"
#endif

// Whether two surfaces are alike enough to share samples. Depth is relative to the distance, so that scale doesn't matter.
bool similar(PackedSurface a, PackedSurface b, float depthThreshold, float cosine, float albedoThreshold) {
  if (abs(a.distance - b.distance) > depthThreshold * a.distance) return false;
  if (dot(surfaceNormal(a), surfaceNormal(b)) < cosine) return false;
  const vec3 albedo = abs(unpackAlbedo(a.diffuse) - unpackAlbedo(b.diffuse));
  return max(albedo.x, max(albedo.y, albedo.z)) <= albedoThreshold;
}

#endif
