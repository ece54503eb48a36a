// Smaller copies of an image for textures seen from afar. Used by scene/upload.
#pragma once

#include <weir/scene/scene.h>

#include <cstdint>
#include <vector>

namespace weir::scene {

/// What a texel's channels mean, and so how they are averaged.
struct MipContent {
  bool srgb = false;           ///< red, green and blue are sRGB codes: averaged as linear light. Alpha never is
  bool weightByAlpha = false;  ///< colours count as much as they are seen: those of see-through texels don't bleed
  bool operator==(const MipContent&) const = default;
};

/// Levels down to one texel: 1 + floor(log2(longer side)).
uint32_t mipLevelCount(uint32_t width, uint32_t height);

/// Levels 1, 2, … of an image, RGBA with 8 bits a channel, tightly packed one behind the other; level l has
/// max(1, side >> l) texels a side. Each texel is the mean over exactly the area that it covers of the level before,
/// also where sides are odd, and only what is stored is rounded: the mean of a level differs from that of level 0 by
/// rounding alone. With weightByAlpha a texel's colour counts 1/256 + alpha · 255/256. Vectors of normal maps are
/// averaged as they are; whoever reads them normalises.
std::vector<uint8_t> makeMipmaps(const Image& image, const MipContent& content);

}  // namespace weir::scene
