// The balance heuristic of all domains (Talbot et al. 2005): m_i(y) = c_i p̂_i(y) / Σ_j c_j p̂_j(y). Every sample is evaluated at every
// surface, k² of them; surfaces are unpacked again each time, which is cheaper than to keep them all in registers.
Reservoir merge(Surface surface, Reservoir own) {
  const uint count = neighbourCount();
  float total = 0.0;
  Selection selection = noSelection();
  for (uint i = 0u; i <= count; ++i) {
    const bool isOwn = i == count;
    Reservoir r = own;
    if (!isOwn) r = neighbourReservoir(i);
    const float chance = nextChance();
    total += r.confidence;
    if (isNull(r)) continue;
    const LightSample here = evaluateLight(lightOf(r), r.place, surface.position);
    const vec3 f = unshadowed(surface, here);
    const float target = luminance(f);
    if (!(target > 0.0)) continue;
    // Visibility is part of the others' targets, not of this pixel's: hidden here is gone by the test at the end.
    float sum = own.confidence * target;
    float itsOwn = MUTANT(23, target, sum);
    for (uint j = 0u; j < count; ++j) {
      const Surface neighbour = neighbourSurface(j);
      const LightSample there = lightThere(lightOf(r), r.place, neighbour.position);
      const bool seen = isSeen(r) && (j == i || (isOwn && isThisSurface(j)));
      const float theirs = neighbourReservoir(j).confidence * neighbourTarget(neighbour, there, seen) * measureThere(there, here);
      sum += MUTANT(22, j == i ? theirs : 0.0, theirs);
      if (j == i) itsOwn = theirs;
    }
    const float weight = isOwn ? r.weight : weightHere(r, here);
    offerMerged(selection, r, f, itsOwn / sum, weight, isSeen(r) && (isOwn || isThisSurface(i)), chance);
  }
  return finishMerge(selection, surface, total, own);
}
