#include <weir/scene/spatial_sort.h>

#include <algorithm>
#include <limits>
#include <thread>

namespace weir::scene {
namespace {

constexpr size_t kThreadedItems = 1u << 14;

struct Box {
  glm::vec3 low{std::numeric_limits<float>::max()}, high{std::numeric_limits<float>::lowest()};
};

Box boxOf(std::span<const SortItem> items) {
  Box box;
  for (const SortItem& item : items) {
    box.low = glm::min(box.low, item.low);
    box.high = glm::max(box.high, item.high);
  }
  return box;
}

double area(const Box& box) {
  const glm::dvec3 d = glm::dvec3(box.high) - glm::dvec3(box.low);
  return d.x * d.y + d.y * d.z + d.z * d.x;
}

void splitAtMedian(std::span<SortItem> items, int axis) {
  std::nth_element(
      items.begin(), items.begin() + static_cast<ptrdiff_t>(items.size() / 2), items.end(),
      [axis](const SortItem& a, const SortItem& b) { return a.low[axis] + a.high[axis] < b.low[axis] + b.high[axis]; });
}

void sortPart(std::span<SortItem> items, bool threaded) {
  // Two items have one split; their order does not matter.
  while (items.size() > 2) {
    const size_t half = items.size() / 2;
    int best = 0, last = 0;
    double least = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      splitAtMedian(items, axis);
      last = axis;
      const double cost = area(boxOf(items.first(half))) * static_cast<double>(half) +
                          area(boxOf(items.subspan(half))) * static_cast<double>(items.size() - half);
      if (cost < least) {
        least = cost;
        best = axis;
      }
    }
    if (best != last) splitAtMedian(items, best);
    if (threaded && items.size() >= kThreadedItems) {
      std::jthread other([&] { sortPart(items.first(half), false); });
      sortPart(items.subspan(half), false);
      return;
    }
    sortPart(items.first(half), false);
    items = items.subspan(half);
  }
}

}  // namespace

void spatialSort(std::span<SortItem> items) {
  sortPart(items, true);
}

}  // namespace weir::scene
