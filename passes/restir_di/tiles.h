// Presampled tiles (Wyman and Panteleev 2021, "Rearchitecting Spatiotemporal Resampling for Production"): buffers that
// restir_di.Initial fills anew in every frame with lights drawn from the whole table, and when it uses them.
#pragma once

#include <weir/pass/pass.h>

#include <array>
#include <cstdint>
#include <string>

namespace weir::passes {

/// As many entries as a pixel has candidates at most, a power of two: each candidate comes from a part of its own.
inline constexpr uint32_t kTileSize = 1024;
inline constexpr uint32_t kTileCount = 128;
inline constexpr uint32_t kTileEntries = kTileSize * kTileCount;

/// From so many lights on `tiles: "auto"` uses tiles: a table of fewer stays in the caches that each pixel's picks are
/// served from.
inline constexpr uint32_t kTilesFrom = 4096;

/// A drawn light as the loop over candidates reads it, 16 bytes.
struct TileSample {
  float position[3];  ///< world, metres
  /// Intensity divided by the probability that the light was drawn with: a shared exponent and 3 × 8 bits
  /// (shaders/restir_di/tiles.glsl). 0: a light of another kind, all of which is in the beside TileLight.
  uint32_t color;
};

/// Which light it is; only what is chosen is looked up.
struct TileIndex {
  uint32_t light;
};

/// GpuLight once more, for lights that need all of it: read in a row instead of from all over the table.
struct TileLight {
  float position[3];
  uint32_t kind;
  float radiance[3];
  float pdf;
  float a[3];
  uint32_t triangle;
  float b[3];
  float area;
};

/// `choice` is the parameter: auto, on or off.
inline bool usesTiles(const std::string& choice, const LightSummary& lights) {
  if (lights.count == 0 || choice == "off") return false;
  return choice == "on" || lights.count >= kTilesFrom;
}

}  // namespace weir::passes

namespace weir {

template <>
struct LayoutOf<passes::TileSample> {
  static constexpr const char* name = "TileSample";
  static constexpr uint32_t version = 1, emptyWord = 0;
  static constexpr std::array<Field, 2> fields{{{"vec3", "position"}, {"uint", "color"}}};
};

template <>
struct LayoutOf<passes::TileIndex> {
  static constexpr const char* name = "TileIndex";
  static constexpr uint32_t version = 1, emptyWord = 0;
  static constexpr std::array<Field, 1> fields{{{"uint", "light"}}};
};

template <>
struct LayoutOf<passes::TileLight> {
  static constexpr const char* name = "TileLight";
  static constexpr uint32_t version = 1, emptyWord = 0;
  static constexpr std::array<Field, 8> fields{{{"vec3", "position"},
                                                {"uint", "kind"},
                                                {"vec3", "radiance"},
                                                {"float", "pdf"},
                                                {"vec3", "a"},
                                                {"uint", "triangle"},
                                                {"vec3", "b"},
                                                {"float", "area"}}};
};

}  // namespace weir
