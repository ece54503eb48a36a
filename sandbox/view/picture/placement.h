// Where a picture lies on the canvas: zoom, pan, and which of its pixels is under the mouse. Canvas coordinates are in
// pixels from its top left corner.
#pragma once

#include <cstdint>
#include <optional>

#include "view/picture/channels.h"

namespace weir::view {

/// A part of the canvas; may reach beyond it.
struct Rect {
  int32_t x = 0, y = 0;
  uint32_t width = 0, height = 0;
};

/// The picture's top left corner, and canvas pixels for one of its own.
struct Placement {
  float x = 0.0f, y = 0.0f;
  float scaleX = 1.0f, scaleY = 1.0f;
};

/// The largest at which all of it is seen, in the middle.
Placement fit(const Extent& extent, const Rect& rect);
/// Pixel for pixel, or `scale` canvas pixels each, in the middle; corners on whole canvas pixels.
Placement centred(const Extent& extent, const Rect& rect, float scale = 1.0f);
/// Zoomed by a factor about a point of the canvas, which stays where it is. Scales stay between 1/1024 and 1024.
Placement zoomed(const Placement& placement, float x, float y, float factor);
/// Where a port of another size lies so that it covers the same: half-size ports beside full ones.
Placement sameArea(const Placement& placement, const Extent& from, const Extent& to);

/// The pixel whose value is shown at the middle of a canvas pixel; none outside of the picture.
struct PixelPlace {
  uint32_t x = 0, y = 0;
  bool operator==(const PixelPlace&) const = default;
};
std::optional<PixelPlace> pixelAt(const Placement& placement, const Extent& extent, int32_t x, int32_t y);

}  // namespace weir::view
