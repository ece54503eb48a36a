// How often each light was seen of late from a tile of 16 × 16 pixels (restir_di.VisibilityCache writes it): a guess at the visibility
// before any ray. Selections prefer what is likely seen; since W makes up for every preference and MIS weights never look here, what is
// unbiased stays so whatever the guess (docs/estimators.md). Passes without the input have the guess 1 everywhere.
#ifndef WEIR_VISIBILITY_CACHE
#define WEIR_VISIBILITY_CACHE

#include "mutants.glsl"
#include "random_bits.glsl"

#ifndef CACHE_TILE
#define CACHE_TILE 16u
#endif
const uint kCacheTile = CACHE_TILE;

uint cacheTile(uvec2 pixel) { return pixel.y / kCacheTile * ((frameWidth + kCacheTile - 1u) / kCacheTile) + pixel.x / kCacheTile; }

// Which of a tile's cells a light has; in scenes of more lights than cells several share one.
uint cacheCell(uint light, uint lights, uint cells) { return lights <= cells ? light : scaleBits(light * 0x9e3779b1u, cells); }

#if defined(has_in_visibility) || defined(has_out_visibility)
// A cell: the guess in 8 bits, and what it comes from, times seen and times looked, in eighths, 12 bits each.
float cachedVisibility(VisibilityCell cell) { return max(float(cell.bits & 255u), 1.0) / 255.0; }
vec2 cachedCounts(VisibilityCell cell) { return vec2((cell.bits >> 8u) & 4095u, cell.bits >> 20u) / 8.0; }
VisibilityCell cacheCellOf(vec2 counts, float guess) {
  const uvec2 whole = uvec2(min(counts * 8.0 + 0.5, 4095.0));
  return VisibilityCell(uint(guess * 255.0 + 0.5) | (whole.x << 8u) | (whole.y << 20u));
}

// Cells that nothing was written into yet are all zero: nobody looked.
float guessOf(VisibilityCell cell) { return cell.bits == 0u ? 1.0 : cachedVisibility(cell); }
#endif

#ifdef has_in_visibility
float guessVisibility(uint tile, uint light) {
  return guessOf(in_visibility[tile * in_visibility_count + cacheCell(light, uint(sceneLightCount), in_visibility_count)]);
}
#else
float guessVisibility(uint tile, uint light) { return 1.0; }
#endif

#endif
