// Fills the tiles (tiles.glsl): one light by power and uniformly for each entry. The entries of a tile come from as many equal parts of the
// table, one each: together they have its distribution, with less chance in how often a light comes.
#include "mutants.glsl"
#include "lights.glsl"
#include "tiles.glsl"

// `id`: entry and tile.
void run(uvec2 id) {
  Random random = randomFor(id, 1u);
  uvec4 bits = nextBits4(random);
  // All of the 32 bits' range: with stratumBits() the last light of millions would come too rarely.
  bits.x = id.x * (MUTANT(34, 0x40000000u, 0x80000000u) / uint(TILE_SIZE / 2)) + bits.x / uint(TILE_SIZE);
  const uint chosen = pickMixed(bits.xy, param_uniformShare);
  const Light light = sceneLights[chosen];
  const uint entry = id.y * uint(TILE_SIZE) + id.x;
  scratch_tileIndices[entry].light = MUTANT(35, (chosen + 1u) % lightCount(), chosen);
  TileSample tile = TileSample(light.position, 0u);
#ifdef SCENE_SHAPED_LIGHTS
  const bool plain = (light.kind & kKindMask) == kPoint && !(light.b.z > 0.0);
#else
  const bool plain = (light.kind & kKindMask) == kPoint;
#endif
  if (plain) tile.color = packColor(light.radiance / mixedPdf(light, param_uniformShare));
  scratch_tiles[entry] = tile;
#ifdef TILE_LIGHTS
  if (tile.color == 0u) {
    scratch_tileLights[entry] =
        TileLight(light.position, light.kind, light.radiance, light.pdf, light.a, light.triangle, light.b, light.area);
  }
#endif
}
