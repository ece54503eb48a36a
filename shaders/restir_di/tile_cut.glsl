// Picks by place begin in the middle of the light tree: a tile's workgroup works out once what all the nodes of one level are worth to
// the tile, and each pick is a search in their sums. That takes the place of the upper half of every descent, and one choice among all of
// the nodes follows their worths better than many between a few.
#ifndef WEIR_TILE_CUT
#define WEIR_TILE_CUT

#include "tile_region.glsl"

const uint kMostCut = 1024u;  // 2^LightTree::kMostCutLevels
const uint kOwnMost = kMostCut / kTilePixels;
const uint kRow = kGroups + 1u;  // of sums of a group's threads: another bank each

// Σ over all of a workgroup's threads, in no particular order.
float sumOfTile(float own) {
  const uint thread = gl_LocalInvocationIndex;
  tileWords[kMostCut + thread] = floatBitsToUint(own);
  barrier();
  if (thread < kGroups) {
    float sum = 0.0;
    for (uint i = 0u; i < kTilePixels; i += kGroups) sum += uintBitsToFloat(tileWords[kMostCut + i + thread]);
    groupWords[thread] = floatBitsToUint(sum);
  }
  barrier();
  float sum = 0.0;
  for (uint i = 0u; i < kGroups; ++i) sum += uintBitsToFloat(groupWords[i]);
  return sum;
}

// Σ over the threads before this one, and over all of them.
uint sumBefore(uint own, out uint total) {
  const uint thread = gl_LocalInvocationIndex;
  const uint at = kMostCut + thread / kGroups * kRow + thread % kGroups;
  tileWords[at] = own;
  barrier();
  if (thread < kGroups) {
    uint sum = 0u;
    for (uint i = 0u; i < kGroups; ++i) {
      const uint place = kMostCut + thread * kRow + i, one = tileWords[place];
      tileWords[place] = sum;
      sum += one;
    }
    groupWords[kGroups + thread] = sum;
  }
  barrier();
  uint before = tileWords[at];
  total = 0u;
  for (uint i = 0u; i < kGroups; ++i) {
    const uint sum = groupWords[kGroups + i];
    if (i < thread / kGroups) before += sum;
    total += sum;
  }
  return before;
}

// All of a workgroup must call it, after gatherRegion(). What the nodes of the cut are worth, in whole parts of about 2³⁰ that are summed
// up in tileWords, so that a pick's chance is what it is divided by. Their sum; 0: nothing that has a place can light the tile.
uint sumCut() {
  const Region region = tileRegion();
  const uint thread = gl_LocalInvocationIndex, count = 1u << lightTree.cutLevels;
  for (uint i = thread; i < count; i += kTilePixels) tileWords[i] = floatBitsToUint(nodeImportance(region, lightNodes[count + i]));
  barrier();
  const uint each = max(count / kTilePixels, 1u);
  float worths[kOwnMost];
  float sum = 0.0;
  for (uint i = 0u; i < kOwnMost; ++i) {
    const uint node = thread * each + i;
    worths[i] = i < each && node < count ? uintBitsToFloat(tileWords[node]) : 0.0;
    sum += worths[i];
  }
  const float scale = 1073741824.0 / sumOfTile(sum);
  uint parts[kOwnMost];
  uint own = 0u;
  for (uint i = 0u; i < kOwnMost; ++i) {
    parts[i] = worths[i] > 0.0 ? 1u + uint(worths[i] * scale) : 0u;
    own += parts[i];
  }
  uint total;
  uint end = sumBefore(own, total);
  for (uint i = 0u; i < kOwnMost; ++i) {
    const uint node = thread * each + i;
    end += parts[i];
    if (i < each && node < count) tileWords[node] = end;
  }
  barrier();
  return total;
}

// A light for a tile, for which sumCut() found `total`. All three of `random` are uniform; the first decides, and numbers next to each
// other pick lights next to each other: picks from even parts of its range are spread over what there is.
Pick pickByPlace(uint total, uvec3 random, inout Random more) {
  uint bits = random.x;
  float pdf = 1.0;
  uint rest;
  const uint unplaced = unplacedShare(total > 0u);
  if (unplaced > 0u) {
    const uint drawn = drawBelow(bits, random.y, 16777216u, rest);
    const bool taken = drawn < unplaced;
    const uint parts = taken ? unplaced : 16777216u - unplaced;
    bits = restOfDraw(taken ? drawn : drawn - unplaced, parts, rest);
    pdf = float(parts) * (1.0 / kParts);
    if (taken) {
      const Pick pick = pickUnplaced(bits);
      return Pick(pick.light, MUTANT(83, pick.pdf, pick.pdf * pdf));
    }
  }
  if (total == 0u) return Pick(0u, 0.0);
  const uint drawn = drawBelow(bits, random.z, total, rest), count = 1u << lightTree.cutLevels;
  uint node = 0u;
  for (uint step = count / 2u; step > 0u; step /= 2u) {
    if (drawn >= tileWords[node + step - 1u]) node += step;
  }
  const uint begin = node == 0u ? 0u : tileWords[node - 1u], parts = tileWords[node] - begin;
  pdf *= MUTANT(81, 1.0 / float(count), float(parts) / float(total));
  const Pick pick = pickBelow(tileRegion(), count + node, restOfDraw(drawn - begin, parts, rest), more);
  return Pick(pick.light, pick.pdf * pdf);
}

#endif
