// By the confidence of the domains that contain the sample: m_i(y) = c_i / Z(y), Z(y) = Σ c_j over the domains j (Bitterli et al. 2020,
// algorithm 6). Only the survivor needs its Z: the choice goes by confidence alone, and what was chosen makes up for it after.
//
// A neighbour's domain is where p̂_j(y) ≥ t p̂_c(y), t = zThreshold. With t = 0, p̂_j(y) > 0, a neighbour that finds y once in a million
// frames has as large a part of it as any other: rare and huge, so that long means are too dark for ever. m_i still sums to one, and
// no part is larger than 1/t of the neighbour's own estimate. The own domain must hold everything then: c_c > 0.
Reservoir merge(Surface surface, Reservoir own) {
  const uint count = neighbourCount();
  float others = 0.0;
  for (uint i = 0u; i < count; ++i) others += neighbourReservoir(i).confidence;
  const float total = own.confidence + others;
  Selection selection = noSelection();
  const float threshold = own.confidence > 0.0 ? param_zThreshold : 0.0;
  uint from = count;  // whose sample was chosen; `count`: the own one
  bool seenThere = false;
  for (uint i = 0u; i < count; ++i) {
    const Reservoir r = neighbourReservoir(i);
    const float chance = nextChance();
    if (isNull(r)) continue;
    const LightSample here = evaluateLight(lightOf(r), r.place, surface.position);
    const bool seen = isSeen(r) && isThisSurface(i);
    if (offerMerged(selection, r, unshadowed(surface, here), r.confidence / total, weightHere(r, here), seen, chance)) {
      from = i;
      seenThere = isSeen(r);
    }
  }
  const float chance = nextChance();
  if (!isNull(own)) {
    const vec3 f = unshadowed(surface, evaluateLight(lightOf(own), own.place, surface.position));
    if (offerMerged(selection, own, f, own.confidence / total, own.weight, isSeen(own), chance)) from = count;
  }
  Reservoir merged = finishMerge(selection, surface, total, own);
  if (isNull(merged)) return merged;

  const LightSample here = evaluateLight(lightOf(merged), merged.place, surface.position);
  float z = own.confidence;  // p̂ > 0 here, and seen if that counts
  for (uint i = 0u; i < count; ++i) {
    const Surface neighbour = neighbourSurface(i);
    const LightSample there = lightThere(lightOf(merged), merged.place, neighbour.position);
    const float theirs = neighbourTarget(neighbour, there, i == from ? seenThere : from == count && isSeen(own) && isThisSurface(i)) * measureThere(there, here);
    if (MUTANT(24, true, theirs > 0.0 && theirs >= threshold * selection.target)) {
      z += neighbourReservoir(i).confidence;
    } else if (i == from) {
      // Hidden where it comes from, or next to never found there: its part of the sum is in the others' weights.
      if (MUTANT(25, false, MUTANT(7, false, true))) {
        mergedLight = vec3(0.0);
        return nullReservoir(total);
      }
    }
  }
  merged.weight *= total / z;
  mergedLight *= total / z;
  return merged;
}
