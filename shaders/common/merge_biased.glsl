// By confidence alone: m_i = c_i / C (Bitterli et al. 2020, algorithm 4). Cheapest; light is lost where others' targets vanish.
Reservoir merge(Surface surface, Reservoir own) {
  const uint count = neighbourCount();
  float others = 0.0;
  for (uint i = 0u; i < count; ++i) others += neighbourReservoir(i).confidence;
  const float total = own.confidence + others;
  Selection selection = noSelection();
  for (uint i = 0u; i < count; ++i) {
    const Reservoir r = neighbourReservoir(i);
    const float chance = nextChance();
    if (isNull(r)) continue;
    const LightSample here = evaluateLight(lightOf(r), r.place, surface.position);
    offerMerged(selection, r, unshadowed(surface, here), r.confidence / total, weightHere(r, here), isSeen(r) && isThisSurface(i),
                chance);
  }
  const float chance = nextChance();
  if (!isNull(own)) {
    const vec3 f = unshadowed(surface, evaluateLight(lightOf(own), own.place, surface.position));
    offerMerged(selection, own, f, own.confidence / total, own.weight, isSeen(own), chance);
  }
  return finishMerge(selection, surface, total, own);
}
