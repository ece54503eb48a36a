// Defensive pairwise MIS (Bitterli 2022; Lin et al. 2022, section 7): each neighbour is paired with the canonical sample,
//   m_j = (c_j/T) · B p̂_j(x_j) / (c_c p̂_c(x_j) + B p̂_j(x_j)),
//   m_c = c_c/T + Σ_j (c_j/T) · c_c p̂_c(x_c) / (c_c p̂_c(x_c) + B p̂_j(x_c)),    B = Σ_j c_j, T = B + c_c.
// Visibility is part of p̂_j, not of p̂_c: hidden here is gone by the test at the end.
Reservoir merge(Surface surface, Reservoir own) {
  const uint count = neighbourCount();
#ifdef ORACLE_V
  oracleSurface = surface;
#endif
  float others = 0.0;
  for (uint i = 0u; i < count; ++i) others += neighbourReservoir(i).confidence;
  const float total = own.confidence + others;
  LightSample ownLight;
  float ownTarget = 0.0;
  if (!isNull(own)) {
    ownLight = evaluateLight(lightOf(own), own.place, surface.position);
    ownTarget = targetFunction(surface, ownLight);
  }
  float ownMis = own.confidence / total;
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
      const float here = own.confidence * ownTarget;
      const float theirs = others * neighbourTarget(paired, there, isSeen(own) && isThisSurface(i)) * measureThere(there, ownLight);
      ownMis += MUTANT(17, 0.0, r.confidence / total * (here / (here + theirs)));
    }
    if (isNull(r)) continue;
    const LightSample here = evaluateLight(lightOf(r), r.place, surface.position);
    const float target = targetFunction(surface, here);
    if (!(target > 0.0)) continue;
    float weight = r.confidence / total;
    const LightSample there = lightThere(lightOf(r), r.place, neighbour.position);
    const float theirs = MUTANT(18, r.confidence, others) * neighbourTarget(neighbour, there, isSeen(r)) * measureThere(there, here);
    weight *= MUTANT(21, 1.0, theirs / (own.confidence * target + theirs));
    const float preferred = preference(r);
    offer(selection, lightOf(r), r.place, target * preferred,
          weight * MUTANT(19, targetFunction(neighbour, there), target) * preferred * weightHere(r, here), MUTANT(20, isSeen(r), isSeen(r) && isThisSurface(i)), chance);
  }
  const float chance = nextChance();
  if (ownTarget > 0.0) {
    ownTarget *= preference(own);
    offer(selection, lightOf(own), own.place, ownTarget, ownMis * ownTarget * own.weight, isSeen(own), chance);
  }
  return finishMerge(selection, surface, total);
}
