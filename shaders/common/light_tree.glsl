// Picks of a light by power and by where it is for some surfaces, from a tree over the scene's lights (framework/scene/light_tree.h;
// Conty Estevez and Kulla 2018): docs/lights.md. Every light that can light any of the surfaces has a probability above 0.
#ifndef WEIR_LIGHT_TREE
#define WEIR_LIGHT_TREE

#include "mutants.glsl"
#include "random.glsl"
#include "random_bits.glsl"

const float kParts = 16777216.0;  // of a choice

// What lights are judged for: a box around the places of surfaces and one around their geometric normals.
struct Region {
  vec3 middle;         // of the places, m
  vec3 centre;         // the same in tree units
  vec3 reach;           // of the places' sides, in tree units
  float spread;        // mean squared distance of what is spread evenly over the places' box from its middle
  vec3 normal;         // middle of the normals
  vec3 perReach, perD;  // how much lights can stand higher for each unit of the boxes' half sides, and of their distance
};

struct Pick {
  uint light;
  float pdf;  // 0: none
};

Region regionOf(vec3 low, vec3 high, vec3 normalLow, vec3 normalHigh) {
  Region r;
  r.middle = 0.5 * low + 0.5 * high;
  r.centre = (r.middle - lightTree.origin) * lightTree.unit + 1.0;
  r.reach = max(high - r.middle, r.middle - low) * lightTree.unit;
  r.spread = dot(r.reach, r.reach) * (1.0 / 3.0);
  r.normal = 0.5 * normalLow + 0.5 * normalHigh;
  // Shading rounds its own cosine, and may find light where none is expected: a part in 2²⁰ more.
  r.perD = max(normalHigh - r.normal, r.normal - normalLow) + 1.0 / 1048576.0;
  r.perReach = abs(r.normal) + r.perD;
  return r;
}

// How much lights in a box are worth to a region: power · cosine / d². `d` is from the middle of the surfaces to that of the lights'
// box, `reach` are half of its sides, in tree units. 0 only if all of the box lies below every surface's horizon.
float importance(Region region, vec3 d, vec3 reach, float power) {
  // How far above a surface's plane a light can be: (n̄ + ν) · (d + δ) with the largest product of each part.
  const float up = dot(region.normal, d);
  const float height = MUTANT(86, up, up + dot(region.perReach, reach + region.reach) + dot(region.perD, abs(d)));
  // From the middle of the lights to the nearest of the surfaces; what is spread evenly over half a side h is h²/3 from its middle.
  const vec3 gap = max(abs(d) - region.reach, 0.0);
  const float d2 = dot(gap, gap) + dot(reach, reach) * (1.0 / 3.0) + region.spread;
  const float near = inversesqrt(max(d2, 1.0 / 1099511627776.0));  // 2⁻⁴⁰ of the scene's size: places aren't known better
  return height > 0.0 ? power * clamp(height * near, 1.0 / 16777216.0, 1.0) * near * near : 0.0;
}

// Of a node, as scene/light_tree.h packs it.
float nodeImportance(Region region, uvec4 node) {
  const vec3 middle = uintBitsToFloat(0x3f800000u | uvec3((node.x >> 9u) & 0x7ffffcu, (node.y >> 9u) & 0x7ffffcu,
                                                          ((node.x & 0x7ffu) << 12u) | ((node.y & 0x7ffu) << 1u)));
  const vec3 reach = uintBitsToFloat((uvec3(node.z << 18u, node.z << 8u, node.z >> 2u) & 0x0ffc0000u) + 0x30800000u);
  return importance(region, middle - region.centre, reach, uintBitsToFloat(node.w));
}

// A number below `total`, with the 64 bits of `bits` and `fresh`: each is as likely to within 2⁻³². `rest` is uniform again.
uint drawBelow(uint bits, uint fresh, uint total, out uint rest) {
  uint high, low, more, least;
  umulExtended(bits, total, high, low);
  umulExtended(fresh, total, more, least);
  rest = low + more;
  return high + (rest < low ? 1u : 0u);
}

// What a draw leaves that took number `nth` of `parts` of what was drawn: uniform, and next to each other where draws were.
uint restOfDraw(uint nth, uint parts, uint rest) {
  const float scaled = (float(nth) + float(rest) * (1.0 / 4294967296.0)) * (4294967296.0 / float(parts));
  return (uint(min(scaled, 4294967040.0)) & ~255u) | (rest & 255u);
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

// Share of the picks, in parts of 2²⁴, that go to lights without a place. `placed`: whether any other light is worth anything.
uint unplacedShare(bool placed) {
  if (lightTree.unplaced == 0u) return 0u;
  return placed ? lightTree.unplacedShare : 16777216u;
}

// Probability of picking the last of the lights without a place: of an environment, if the scene has one.
float lastUnplacedPdf(bool placed) {
  const uint last = lightTree.lights + lightTree.unplaced - 1u;
  const uint before = lightTree.unplaced > 1u ? lightTree.entries[last - 1u].y : 0xffffffffu;
  const uint numbers = lightTree.entries[last].y - before;
  return (numbers == 0u ? 1.0 : float(numbers) * (1.0 / 4294967296.0)) * float(unplacedShare(placed)) * (1.0 / kParts);
}

// The first light of a leaf, for the number of leaves that of all lights: ⌊leaf · n / 2^levels⌋.
uint firstOfLeaf(uint leaf) {
  uint high, low;
  umulExtended(leaf, lightTree.lights, high, low);
  return lightTree.levels == 0u ? low : (high << (32u - lightTree.levels)) | (low >> lightTree.levels);
}

float lightImportance(Region region, uint light) {
  const vec4 placed = placedLights[light];
#ifdef SCENE_TRIANGLE_LIGHTS
  const float radius = uintBitsToFloat(lightTree.entries[light].y) * lightTree.unit;
#else
  const float radius = 0.0;
#endif
  return importance(region, (placed.xyz - region.middle) * lightTree.unit, vec3(radius), placed.w);
}

// Of four lights from `first` on; those beyond `last` are worth nothing. None is left out, so that all are read at the same time.
vec4 lightImportances(Region region, uint first, uint last) {
  const vec4 worths = vec4(lightImportance(region, min(first, last)), lightImportance(region, min(first + 1u, last)),
                           lightImportance(region, min(first + 2u, last)), lightImportance(region, min(first + 3u, last)));
  return mix(vec4(0.0), worths, lessThanEqual(first + uvec4(0u, 1u, 2u, 3u), uvec4(last)));
}

// In whole parts, of which whatever is worth anything has one at least: so many of all parts are a chance, and what a pick is divided by.
uvec4 partsOf(vec4 worths, float scale) { return uvec4(worths * scale) + uvec4(greaterThan(worths, vec4(0.0))); }
uvec4 endsOf(uvec4 parts) {
  const uint two = parts.x + parts.y, three = two + parts.z;
  return uvec4(parts.x, two, three, three + parts.w);
}

// Which of four holds number `drawn` below the last end.
struct Slice {
  uint index, begin, parts;
};
Slice sliceAt(uvec4 ends, uint drawn) {
  const uint begin = drawn < ends.x ? 0u : drawn < ends.y ? ends.x : drawn < ends.z ? ends.y : ends.z;
  const uint end = drawn < ends.x ? ends.x : drawn < ends.y ? ends.y : drawn < ends.z ? ends.z : ends.w;
  return Slice(uint(drawn >= ends.x) + uint(drawn >= ends.y) + uint(drawn >= ends.z), begin, end - begin);
}

// One of a leaf's lights.
Pick pickInLeaf(Region region, uint leaf, uint bits, uint fresh) {
  const uint first = firstOfLeaf(leaf), count = firstOfLeaf(leaf + 1u) - first;
  const vec4 some = lightImportances(region, first, first + count - 1u), rest = lightImportances(region, first + 4u, first + count - 1u);
  const float sum = dot(some, vec4(1.0)) + dot(rest, vec4(1.0));
  if (!(sum > 0.0)) return Pick(0u, 0.0);
  const uvec4 ends = endsOf(partsOf(some, kParts / sum)), restEnds = endsOf(partsOf(rest, kParts / sum));
  const uint total = ends.w + restEnds.w;
  uint unused;
  const uint drawn = drawBelow(bits, fresh, total, unused);
  const bool isSome = drawn < ends.w;
  const Slice slice = sliceAt(isSome ? ends : restEnds, isSome ? drawn : drawn - ends.w);
  return Pick(lightTree.entries[first + slice.index + (isSome ? 0u : 4u)].x,
              MUTANT(82, 1.0 / float(count), float(slice.parts) / float(total)));
}

// A light under one of the nodes of the cut. `bits` are uniform; neighbouring numbers pick neighbouring lights.
Pick pickBelow(Region region, uint node, uint bits, inout Random random) {
  uvec4 fresh = nextBits4(random);
  float pdf = 1.0;
  for (uint level = lightTree.cutLevels; level < lightTree.levels; level += 2u) {
    node *= 4u;
    const vec4 worths =
        vec4(nodeImportance(region, lightNodes[node]), nodeImportance(region, lightNodes[node + 1u]),
             nodeImportance(region, lightNodes[node + 2u]), nodeImportance(region, lightNodes[node + 3u]));
    const float sum = dot(worths, vec4(1.0));
    if (!(sum > 0.0)) return Pick(0u, 0.0);
    const uvec4 ends = endsOf(partsOf(worths, kParts / sum));
    uint rest;
    const uint drawn = drawBelow(bits, fresh.x, ends.w, rest);
    const Slice slice = sliceAt(ends, drawn);
    node += slice.index;
    pdf *= float(slice.parts) / float(ends.w);
    bits = restOfDraw(drawn - slice.begin, slice.parts, rest);
    fresh = ((level - lightTree.cutLevels) & 6u) == 6u ? nextBits4(random) : fresh.yzwx;
  }
  const Pick pick = pickInLeaf(region, node - (1u << lightTree.levels), bits, fresh.x);
  return Pick(pick.light, pick.pdf * pdf);
}

#endif
