// Initial candidates by streaming RIS, as in initial.glsl, drawn by tiles of 16 × 16 pixels together: each pixel, or every other one,
// picks one light, and all of the tile look through the picks in shared memory. A pixel then reads the light table once instead of M
// times, so that its size hardly matters (presampled tiles, Wyman and Panteleev 2021, without the pass before), and its picks are spread
// over the whole table.
//
// Every pick has the density of pickMixed(), or of pickByPlace() for what the tile's surfaces span, and each pixel looks at M of them
// whose numbers in the tile are uniform, so that the sum of its weights is unbiased as with picks of its own. That neighbours look at the
// same picks makes them alike, not wrong.
#include "initial_weights.glsl"
#ifdef HAS_LIGHT_TREE
#include "tile_cut.glsl"
#endif
#ifdef ORDERS_RAYS
#include "ray_order.glsl"
#endif

#ifdef HAS_LIGHT_TREE
const uint kPickBits = 7u;  // a pick by place costs far more than looks at it, and twice as many find hardly more
#else
const uint kPickBits = 8u;
#endif
const uint kPicks = 1u << kPickBits;
const uint kPlain = 0x80000000u;  // a point light without a range: position and intensity are all there is to it

shared uvec4 pickPlace[kPicks];  // position, and the light's number
shared uvec4 pickPower[kPicks];  // intensity, and the pick's density

// What all picks of a tile share.
struct Tile {
#ifdef HAS_LIGHT_TREE
  uint total;  // of the parts of all nodes of the light tree's cut
#endif
  float environmentPdf;  // of picking the environment, where there is one
};

void pickForTile(Tile tile, uvec2 pixel, uint thread, uint turn) {
  Random random = randomFor(pixel, 1u);
#ifdef HAS_LIGHT_TREE
  random.dimension = turn << 8u;  // a descent takes several
#else
  random.dimension = turn;
#endif
  uvec4 bits = nextBits4(random);
  // One pick in each part of the table: together they have its distribution, with less chance in how often a light comes.
  bits.x = (thread << MUTANT(34, 31u - kPickBits, 32u - kPickBits)) | (bits.x >> kPickBits);
#ifdef HAS_LIGHT_TREE
  const Pick pick = pickByPlace(tile.total, bits.xyz, random);
  if (!(pick.pdf > 0.0)) {
    // A point without light, which is no candidate.
    pickPlace[thread] = uvec4(0u, 0u, 0u, kPlain);
    pickPower[thread] = uvec4(0u, 0u, 0u, floatBitsToUint(1.0));
    return;
  }
  const uint chosen = pick.light;
  const Light light = sceneLights[chosen];
  const float pdf = pick.pdf;
#else
  const uint chosen = pickMixed(bits.xy, param_uniformShare);
  const Light light = sceneLights[chosen];
  const float pdf = mixedPdf(light, param_uniformShare);
#endif
#ifdef SCENE_SHAPED_LIGHTS
  const bool plain = (light.kind & kKindMask) == kPoint && !(light.b.z > 0.0);
#else
  const bool plain = (light.kind & kKindMask) == kPoint;
#endif
  pickPlace[thread] = uvec4(floatBitsToUint(light.position), MUTANT(35, (chosen + 1u) % lightCount(), chosen) | (plain ? kPlain : 0u));
  pickPower[thread] = uvec4(floatBitsToUint(light.radiance), floatBitsToUint(MUTANT(37, light.pdf, pdf)));
}

#ifdef SCENE_ENVIRONMENT
// The environment is the last light of a scene that has one.
float environmentPickPdf(Tile tile) {
  if (lightCount() == 0u) return 0.0;
#ifdef HAS_LIGHT_TREE
  if (lightTree.unplaced == 0u) return 0.0;
  return lastUnplacedPdf(tile.total > 0u);
#else
  return mixedPdf(sceneLights[lightCount() - 1u], param_uniformShare);
#endif
}
#endif

// `count` of the picks: one in each of as many parts of the tile's, which begin at a random place, so that all are equally likely.
void lookThrough(inout Selection selections[out_reservoirs_count], Tile tile, Surface surface, uint count, uint begin,
                 inout Random random) {
  const uint step = (kPicks << 16u) / count;
  const QuickTarget quick = quickTarget(surface);
  uvec4 words = uvec4(0u);
  for (uint i = 0u; i < count; ++i) {
    words = words.yzwx;
    if ((i & 3u) == 0u) words = nextBits4(random);
    const uint low = (i * step) >> 16u, width = (((i + 1u) * step) >> 16u) - low;
    const uint at = (begin + low + ((MUTANT(36, 0u, words.x & 255u) * width) >> 8u)) & (kPicks - 1u);
    const uvec4 where = pickPlace[at], power = pickPower[at];
    const uint chosen = where.w & ~kPlain;
    const float pdf = uintBitsToFloat(power.w);
    Candidate c;
    c.place = 0u;
    c.spread = 1.0;
    float weight = 0.0;
    if ((where.w & kPlain) != 0u) {
      c.light = evaluatePoint(uintBitsToFloat(where.xyz), uintBitsToFloat(power.xyz), surface.position);
    } else {
      c = drawCandidate(sceneLights[chosen], nextBits4(random).xy, surface, random);
    }
    const float target = quickTargetOf(quick, surface, c.light);
    if (!(target > 0.0)) continue;
    // 1/M · p̂ / p, with p = pdf of the light times density on it.
    weight = target * c.spread / (pdf * float(MUTANT(30, param_candidates + 1, param_candidates)));
#ifdef SCENE_ENVIRONMENT
    if ((where.w & kPlain) == 0u) {
      const Light light = sceneLights[chosen];
      if ((light.kind & kKindMask) == kEnvironment) weight = environmentWeight(surface, tile.environmentPdf, c.light, 1.0 / c.spread, target);
    }
#endif
    if (out_reservoirs_count == 1u) {
      offer(selections[0], chosen, c.place, target, weight, false, uniformFloat(words.x));
    } else {
      offerAll(selections, chosen, c.place, target, weight, false, random);
    }
  }
}

void run(uvec2 pixel) {
  const uint thread = gl_LocalInvocationIndex, index = pixel.y * frameWidth + pixel.x;
  const uint number = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  const bool inside = all(lessThan(pixel, launchSize));
  Selection selections[out_reservoirs_count];
  for (uint k = 0u; k < out_reservoirs_count; ++k) selections[k] = noSelection();

  PackedSurface packed;
  packed.distance = 0.0;
  if (inside) packed = in_surface[index];
  const bool lit = isSurface(packed) && lightCount() > 0u;
  Surface surface;
  if (lit) surface = unpackSurface(packed, pixel, camera, frameSize);
  Random random = randomFor(pixel, 0u);
  uint all = lightCount() > 0u ? uint(param_candidates) : 0u;
  Tile tile;
#ifdef HAS_LIGHT_TREE
  tile.total = 0u;
  if (gatherRegion(lit, surface)) tile.total = sumCut();
  else all = 0u;
#endif
#ifdef SCENE_ENVIRONMENT
  tile.environmentPdf = environmentPickPdf(tile);
#endif
  for (uint done = 0u, turn = 0u; done < all; done += kPicks, ++turn) {
    if (turn > 0u) barrier();
    if (thread < kPicks) pickForTile(tile, pixel, thread, turn);
    barrier();
    const uint begin = MUTANT(36, 0u, pcg4d(uvec4(number, frameIndex, frameSeed ^ launchStream, turn)).x >> 24u);
    if (lit) lookThrough(selections, tile, surface, min(all - done, kPicks), begin, random);
  }
#ifdef SCENE_ENVIRONMENT
  if (lit) lookAlongBsdf(selections, surface, tile.environmentPdf, random);
#endif
  bool ray = false;
  vec3 towards = vec3(0.0);
  for (uint k = 0u; inside && k < out_reservoirs_count; ++k) {
    const Reservoir r = lit ? finish(selections[k], 1.0) : emptyReservoir();
    out_reservoirs[index * out_reservoirs_count + k] = r;
#ifdef ORDERS_RAYS
    if (isNull(r)) continue;
    ray = true;
    towards = evaluateLight(lightOf(r), r.place, surface.position).direction;
#endif
  }
#ifdef ORDERS_RAYS
  if (inside) scratch_keys[index].bits = ray ? rayKey(towards) : kNoRayKey;
#endif
}
