// Picks of a light by power and by where it is for some surfaces, from a tree over the scene's lights (framework/scene/light_tree.h;
// Conty Estevez and Kulla 2018): docs/lights.md. Every light that can light any of the surfaces has a probability above 0.
#ifndef WEIR_LIGHT_TREE
#define WEIR_LIGHT_TREE

#include "mutants.glsl"
#include "random.glsl"
#include "random_bits.glsl"

// Boxes around the places of surfaces and around their geometric normals.
struct Region {
  vec3 low, high, normalLow, normalHigh;
};

struct Pick {
  uint light;
  float pdf;  // 0: none
};

// How much lights in a box are worth to a region: power · cosine / d², where the cosine is a bound of those of all surfaces, and d² a
// mean over both boxes. 0 only if all of the box lies below every surface's horizon.
float importance(Region region, vec3 low, vec3 high, float power) {
  const vec3 near = (low - region.high) * lightTree.unit, far = (high - region.low) * lightTree.unit;  // corners of light - surface
  // How far above a surface's plane a light can be: each axis has the largest product of a normal's and a difference's part.
  const vec3 rise = MUTANT(86, region.normalLow * near, max(max(region.normalLow * near, region.normalLow * far),
                                                            max(region.normalHigh * near, region.normalHigh * far)));
  // Shading rounds its own cosine, and may find light where this is 0 or hardly less.
  const vec3 reach = max(abs(near), abs(far));
  const float height = rise.x + rise.y + rise.z + (reach.x + reach.y + reach.z) * (1.0 / 1048576.0);
  if (!(height > 0.0)) return 0.0;
  const vec3 gap = max(max(near, -far), 0.0);
  const float gap2 = dot(gap, gap);
  const float cosine = height * height < gap2 ? height * inversesqrt(gap2) : 1.0;
  // From the middle of the lights to the nearest of the surfaces; what is spread evenly over a side s is s²/12 from its middle.
  const vec3 middle = 0.5 * low + 0.5 * high;
  const vec3 d = (middle - clamp(middle, region.low, region.high)) * lightTree.unit;
  const vec3 side = (high - low) * lightTree.unit, span = (region.high - region.low) * lightTree.unit;
  const float d2 = dot(d, d) + (dot(side, side) + dot(span, span)) * (1.0 / 12.0);
  return power * cosine / max(d2, 1.0 / 1099511627776.0);  // 2⁻⁴⁰ of the scene's size: places aren't known better
}

// Probability of the first of two in parts of 2²⁴, by their importances; neither that has any goes without.
uint firstShare(float first, float second) {
  const uint share = uint(16777216.0 * (first / (first + second)));
  return clamp(share, first > 0.0 ? 1u : 0u, second > 0.0 ? 16777215u : 16777216u);
}

// Whether a uniform number takes the first of two with that probability, exactly; the number is then uniform again: what the choice used
// up of it is taken from `fresh`.
bool takesFirst(inout uint bits, uint share, uint fresh) {
  const bool first = (bits >> 8u) < share;
  const uint rest = first ? share : 16777216u - share;
  const float scaled = float(first ? bits : bits - (share << 8u)) * (16777216.0 / float(rest));
  bits = (uint(min(scaled, 4294967040.0)) & ~255u) | (fresh & 255u);
  return first;
}

// A light without a place, by power. Each has its numbers out of 2³².
Pick pickUnplaced(uint bits) {
  uint low = lightTree.lights, high = low + lightTree.unplaced - 1u;
  const uint first = low;
  while (low < high) {
    const uint middle = (low + high) / 2u;
    if (bits <= lightTree.entries[middle].y) high = middle;
    else low = middle + 1u;
  }
  // Wraps round: one that has all numbers has 2³².
  const uint before = low == first ? 0xffffffffu : lightTree.entries[low - 1u].y;
  const uint numbers = lightTree.entries[low].y - before;
  return Pick(lightTree.entries[low].x, numbers == 0u ? 1.0 : float(numbers) * (1.0 / 4294967296.0));
}

// Share of the picks, in parts of 2²⁴, that go to lights without a place.
uint unplacedShare(Region region) {
  if (lightTree.unplaced == 0u) return 0u;
  const LightNode root = lightNodes[1];
  return importance(region, root.low, root.high, root.power) > 0.0 ? lightTree.unplacedShare : 16777216u;
}

// Probability of picking the last of the lights without a place: of an environment, if the scene has one.
float lastUnplacedPdf(Region region) {
  const uint last = lightTree.lights + lightTree.unplaced - 1u;
  const uint before = lightTree.unplaced > 1u ? lightTree.entries[last - 1u].y : 0xffffffffu;
  const uint numbers = lightTree.entries[last].y - before;
  return (numbers == 0u ? 1.0 : float(numbers) * (1.0 / 4294967296.0)) * float(unplacedShare(region)) * (1.0 / 16777216.0);
}

// One of a leaf's lights.
Pick pickInLeaf(Region region, uint leaf, inout Random random) {
  const uint first = leaf & 0x0fffffffu, count = leaf >> 28u;
  Pick pick = Pick(0u, 0.0);
  float sum = 0.0;
  vec4 u;
  for (uint i = 0u; i < count; ++i) {
    u = (i & 3u) == 0u ? next4(random) : u.yzwx;
    const vec4 placed = placedLights[first + i];
#ifdef SCENE_TRIANGLE_LIGHTS
    const float radius = uintBitsToFloat(lightTree.entries[first + i].y);
#else
    const float radius = 0.0;
#endif
    const float worth = importance(region, placed.xyz - radius, placed.xyz + radius, placed.w);
    if (!(worth > 0.0)) continue;
    sum += worth;
    if (u.x * sum < worth) pick = Pick(first + i, worth);
  }
  if (!(sum > 0.0)) return Pick(0u, 0.0);
  return Pick(lightTree.entries[pick.light].x, MUTANT(82, 1.0 / float(count), pick.pdf / sum));
}

// A light for a region. `bits` are uniform, and numbers next to each other pick lights next to each other: picks from even parts of
// their range are spread over what there is.
Pick pickByPlace(Region region, uint bits, inout Random random) {
  uvec4 fresh = nextBits4(random);
  float pdf = 1.0;
  const uint unplaced = unplacedShare(region);
  if (unplaced > 0u) {
    const bool taken = takesFirst(bits, unplaced, fresh.x);
    pdf = float(taken ? unplaced : 16777216u - unplaced) * (1.0 / 16777216.0);
    if (taken) {
      const Pick pick = pickUnplaced(bits);
      return Pick(pick.light, MUTANT(83, pick.pdf, pick.pdf * pdf));
    }
  }
  uint node = 1u;
  for (uint level = 0u; level < lightTree.levels; ++level) {
    fresh = (level & 3u) == 3u ? nextBits4(random) : fresh.yzwx;
    const LightNode first = lightNodes[2u * node], second = lightNodes[2u * node + 1u];
    const float a = importance(region, first.low, first.high, first.power);
    const float b = importance(region, second.low, second.high, second.power);
    if (!(a + b > 0.0)) return Pick(0u, 0.0);
    const uint share = firstShare(a, b);
    const bool taken = takesFirst(bits, share, fresh.x);
    const float probability = float(taken ? share : 16777216u - share) * (1.0 / 16777216.0);
    pdf *= MUTANT(81, level + 1u == lightTree.levels ? 0.5 : probability, probability);
    node = 2u * node + (taken ? 0u : 1u);
  }
  const Pick pick = pickInLeaf(region, lightNodes[node].lights, random);
  return Pick(pick.light, pick.pdf * pdf);
}

#endif
