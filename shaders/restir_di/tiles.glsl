// Presampled tiles (Wyman and Panteleev 2021): TILE_COUNT × TILE_SIZE lights drawn anew in every frame. The pixels of a block draw
// their candidates from one tile, in rows that lie next to each other in memory, however many lights the scene has.
//
// A point light's entry holds its place and L/p, its intensity over the probability that it was drawn with, rounded to 8 bits. A
// candidate's weight is then t/M with t = luminance of (BSDF · cosine · L/p / d²), and the target that it was weighed by is p̂' = t·p: a
// little off p̂, but a function of light and surface alone, and positive wherever p̂ is, as no part of a colour is rounded to 0. That is all
// that W = Σw / p̂' asks for.
#ifndef WEIR_TILES
#define WEIR_TILES

#include "mutants.glsl"
#include "random.glsl"
#include "random_bits.glsl"

// In place of a light's index, until it is looked up: the rest is an entry of the tiles.
const uint kTileEntry = 0x40000000u;

// The exponent above, then blue, green, red. 0 stands for no colour.
uint packColor(vec3 c) {
  const float largest = max(c.r, max(c.g, c.b));
  if (!(largest > 0.0) || isinf(largest)) return 0u;
  const uint exponent = max(floatBitsToUint(largest) >> 23u, 8u);
  const float unit = uintBitsToFloat((exponent - 7u) << 23u);
  const vec3 lowest = vec3(greaterThan(c, vec3(0.0)));
  const uvec3 parts = uvec3(clamp(floor(c / unit + 0.5), lowest, vec3(255.0)));
  return exponent << 24u | parts.b << 16u | parts.g << 8u | parts.r;
}

vec3 unpackColor(uint bits) {
  const float unit = uintBitsToFloat(((bits >> 24u) - 7u) << 23u);
  return vec3(bits & 255u, (bits >> 8u) & 255u, (bits >> 16u) & 255u) * unit;
}

// Where in a tile a pixel's candidates lie: M parts of one width, spread evenly over the tile from a start that is the block's own, and in
// each part an entry by the pixel's place in the block. Parts are turned by as much as the block says, each otherwise, so that two blocks
// hardly ever have pixels with all candidates in common. The start is uniform over the tile: every candidate is any entry with the same
// probability. Pixels of a block that would share all their candidates, as M times their number is more than a tile holds, are turned
// otherwise too.
struct TileReader {
  uint first;    // entry of the tile
  uint start;    // in it
  uint spacing;  // of parts, in 1/65536
  uint mask;     // width of a part - 1
  uint place;    // of the pixel in a part
  uint turn, step;
};

// A block is 8 × 4 pixels: with 32 candidates each, a whole tile.
TileReader tileReader(uvec2 pixel, uint candidates) {
  const uvec2 block = uvec2(pixel.x >> 3u, pixel.y >> 2u);
  TileReader r;
  Random random = randomFor(block, 2u);
  const uvec4 bits = nextBits4(random);
  r.first = scaleBits(bits.x, uint(TILE_COUNT)) * uint(TILE_SIZE);
  r.start = MUTANT(36, 0u, bits.y & uint(TILE_SIZE - 1));
  r.spacing = (uint(TILE_SIZE) << 16u) / candidates;
  const uint width = 1u << uint(findMSB(r.spacing >> 16u));
  r.mask = width - 1u;
  const uint inBlock = (pixel.y & 3u) * 8u + (pixel.x & 7u);
  random.dimension += inBlock / width;
  r.place = inBlock * max(width / 32u, 1u);
  const uvec4 turns = nextBits4(random);
  r.turn = MUTANT(36, 0u, turns.x);
  r.step = MUTANT(36, 0u, turns.y | 1u);
  return r;
}

uint tileEntry(TileReader r, uint candidate) {
  const uint turned = (r.place + ((r.turn + candidate * r.step) >> 22u)) & r.mask;
  return r.first + ((r.start + ((candidate * r.spacing) >> 16u) + turned) & uint(TILE_SIZE - 1));
}

#endif
