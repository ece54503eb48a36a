// Defensive pairwise MIS (Bitterli 2022; Lin et al. 2022, section 7): each neighbour is paired with the canonical sample,
//   m_j = (c_j/T) · B p̂_j(x_j) / (c_c p̂_c(x_j) + B p̂_j(x_j)),
//   m_c = c_c/T + Σ_j (c_j/T) · c_c p̂_c(x_c) / (c_c p̂_c(x_c) + B p̂_j(x_c)),    B = Σ_j c_j, T = B + c_c.
// Visibility is part of p̂_j, not of p̂_c: hidden here is gone by the test at the end.
Reservoir merge(Surface surface, Reservoir own) {
  const uint count = neighbourCount();
  float others = 0.0;
  for (uint i = 0u; i < count; ++i) others += neighbourReservoir(i).confidence;
  const float total = own.confidence + others;
  LightSample ownLight;
  vec3 ownLit = vec3(0.0);
  if (!isNull(own)) {
    ownLight = evaluateLight(lightOf(own), own.place, surface.position);
    ownLit = unshadowed(surface, ownLight);
  }
  const float ownTarget = luminance(ownLit);
  float ownMis = own.confidence / total;
  // m_c is a sum over neighbours, of which each term wants to know whether the neighbour sees the own sample. With sparse rays all are
  // taken to see it, and one, picked by chance, is asked: what its term is off by stands for all. W is linear in m_c, whose mean is right.
  uint asked = count;  // `count`: all
#ifdef VISIBILITY_RAYS
  if (param_sparseRays && count > 1u) asked = min(uint(nextChance() * float(count)), count - 1u);
#endif
  Selection selection = noSelection();
  for (uint i = 0u; i < count; ++i) {
    const Reservoir r = neighbourReservoir(i);
    const Surface neighbour = neighbourSurface(i);
    const float chance = nextChance();
    if (ownTarget > 0.0) {
      Surface paired = neighbour;
#ifdef WEIR_MUTANT
      paired.view = MUTANT(8, surface.view, paired.view);
      paired.normal = MUTANT(9, surface.normal, paired.normal);
      paired.diffuse = MUTANT(11, surface.diffuse, paired.diffuse);
#endif
      const LightSample there = lightThere(lightOf(own), own.place, neighbour.position);
      const float here = own.confidence * ownTarget, share = MUTANT(17, 0.0, r.confidence / total);
      const float seen = others * targetFunction(paired, there) * measureThere(there, ownLight);
      const float part = share * (here / (here + seen));
      ownMis += part;
#ifdef VISIBILITY_RAYS
      if ((asked == count || asked == i) && seen > 0.0 && !(isSeen(own) && isThisSurface(i))) {
        const float theirs = MUTANT(6, seen, seen * visibilityThere(neighbour, there));
        ownMis += (share * (here / (here + theirs)) - part) * (asked == count ? 1.0 : MUTANT(72, 1.0, float(count)));
      }
#endif
    }
    if (isNull(r)) continue;
    const LightSample here = evaluateLight(lightOf(r), r.place, surface.position);
    const vec3 f = unshadowed(surface, here);
    const float target = luminance(f);
    if (!(target > 0.0)) continue;
    float weight = r.confidence / total;
    const LightSample there = lightThere(lightOf(r), r.place, neighbour.position);
    const float theirs = MUTANT(18, r.confidence, others) * neighbourTarget(neighbour, there, isSeen(r)) * measureThere(there, here);
    weight *= MUTANT(21, 1.0, theirs / (own.confidence * target + theirs));
    weight *= MUTANT(19, targetFunction(neighbour, there) / target, 1.0);
    offerMerged(selection, r, f, weight, weightHere(r, here), isSeen(r) && MUTANT(20, true, isThisSurface(i)), chance);
  }
  const float chance = nextChance();
  if (ownTarget > 0.0) {
    offerMerged(selection, own, ownLit, ownMis, own.weight, isSeen(own), chance);
  }
  return finishMerge(selection, surface, total, own);
}
