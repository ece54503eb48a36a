#include "view/picture/placement.h"

#include <algorithm>
#include <cmath>

namespace weir::view {
namespace {

Placement inMiddle(const Extent& extent, const Rect& rect, float scale) {
  const float width = scale * static_cast<float>(extent.width), height = scale * static_cast<float>(extent.height);
  return {static_cast<float>(rect.x) + 0.5f * (static_cast<float>(rect.width) - width),
          static_cast<float>(rect.y) + 0.5f * (static_cast<float>(rect.height) - height), scale, scale};
}

}  // namespace

Placement fit(const Extent& extent, const Rect& rect) {
  if (extent.width == 0 || extent.height == 0 || rect.width == 0 || rect.height == 0) return {};
  return inMiddle(extent, rect,
                  std::min(static_cast<float>(rect.width) / static_cast<float>(extent.width),
                           static_cast<float>(rect.height) / static_cast<float>(extent.height)));
}

Placement centred(const Extent& extent, const Rect& rect, float scale) {
  Placement p = inMiddle(extent, rect, scale);
  p.x = std::round(p.x);
  p.y = std::round(p.y);
  return p;
}

Placement zoomed(const Placement& placement, float x, float y, float factor) {
  constexpr float kMost = 1024.0f;
  if (!(factor > 0.0f) || !(placement.scaleX > 0.0f) || !(placement.scaleY > 0.0f)) return placement;
  // Held back together, so that the aspect stays.
  const float least = std::min(placement.scaleX, placement.scaleY), most = std::max(placement.scaleX, placement.scaleY);
  const float f = std::clamp(factor, std::min(1.0f, 1.0f / kMost / least), std::max(1.0f, kMost / most));
  return {x + f * (placement.x - x), y + f * (placement.y - y), f * placement.scaleX, f * placement.scaleY};
}

Placement sameArea(const Placement& placement, const Extent& from, const Extent& to) {
  if (to.width == 0 || to.height == 0) return placement;
  Placement p = placement;
  p.scaleX *= static_cast<float>(from.width) / static_cast<float>(to.width);
  p.scaleY *= static_cast<float>(from.height) / static_cast<float>(to.height);
  return p;
}

std::optional<PixelPlace> pixelAt(const Placement& placement, const Extent& extent, int32_t x, int32_t y) {
  const float u = (static_cast<float>(x) + 0.5f - placement.x) / placement.scaleX;
  const float v = (static_cast<float>(y) + 0.5f - placement.y) / placement.scaleY;
  const bool inside =
      u >= 0.0f && v >= 0.0f && u < static_cast<float>(extent.width) && v < static_cast<float>(extent.height);
  if (!inside) return std::nullopt;
  return PixelPlace{static_cast<uint32_t>(u), static_cast<uint32_t>(v)};
}

}  // namespace weir::view
