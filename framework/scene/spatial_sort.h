// An order of boxes in which every half of every half is compact. Internal to scene/prepare.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

namespace weir::scene {

struct SortItem {
  glm::vec3 low, high;
  uint32_t index;
};

/// Recursively splits at the median centroid, along the axis for which the halves' surface areas sum up smallest.
/// Acceleration structure builders that halve their input in its given order (Mesa's software device) then build good
/// trees. Deterministic; large inputs use two threads. O(n log n).
void spatialSort(std::span<SortItem> items);

}  // namespace weir::scene
