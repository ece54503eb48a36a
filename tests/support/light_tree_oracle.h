// With which probability surfaces pick each light of a tree, in double precision, from docs/lights.md's text and by the
// definition: bounds by trying every corner, probabilities down every path.
#pragma once

#include <weir/scene/light_tree.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/glm.hpp>
#include <vector>

namespace weir::test {

struct Box {
  glm::dvec3 low{1e300}, high{-1e300};
  void add(const glm::dvec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  bool holds(const glm::dvec3& p, double slack) const {
    return glm::all(glm::greaterThanEqual(p, low - slack)) && glm::all(glm::lessThanEqual(p, high + slack));
  }
  glm::dvec3 corner(int i) const {
    return {(i & 1) ? high.x : low.x, (i & 2) ? high.y : low.y, (i & 4) ? high.z : low.z};
  }
};

/// Places and geometric normals of the surfaces of a tile.
struct TileBoxes {
  Box places, normals;
  void add(const glm::dvec3& place, const glm::dvec3& normal) {
    places.add(place);
    normals.add(normal);
  }
};

class LightTreeOracle {
 public:
  explicit LightTreeOracle(const scene::LightTree& tree) : tree_(tree) {}

  double importance(const TileBoxes& tile, const Box& lights, double power) const {
    const double unit = tree_.unit;
    const Box difference{lights.low - tile.places.high, lights.high - tile.places.low};
    double height = -1e300;
    for (int n = 0; n < 8; ++n)
      for (int d = 0; d < 8; ++d)
        height = std::max(height, glm::dot(tile.normals.corner(n), difference.corner(d)) * unit);
    const glm::dvec3 reach = glm::max(glm::abs(difference.low), glm::abs(difference.high)) * unit;
    height += (reach.x + reach.y + reach.z) * 0x1p-20;
    if (!(height > 0.0)) return 0.0;
    const double gap = glm::length(glm::max(glm::max(difference.low, -difference.high), 0.0)) * unit;
    const double cosine = height < gap ? height / gap : 1.0;
    const glm::dvec3 middle = (lights.low + lights.high) / 2.0;
    double d2 = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double nearest = std::clamp(middle[k], tile.places.low[k], tile.places.high[k]);
      d2 += std::pow((middle[k] - nearest) * unit, 2);
      d2 += std::pow((lights.high[k] - lights.low[k]) * unit, 2) / 12.0;
      d2 += std::pow((tile.places.high[k] - tile.places.low[k]) * unit, 2) / 12.0;
    }
    return power * cosine / std::max(d2, 0x1p-40);
  }

  /// By light; their sum is 1 but for what ends where nothing below a node can light the tile.
  std::vector<double> probabilities(const TileBoxes& tile, size_t lights) const {
    std::vector<double> p(lights, 0.0);
    double unplaced = 0.0;
    const size_t placed = tree_.lights.size();
    if (tree_.unplaced() > 0) unplaced = worth(tile, 1) > 0.0 ? tree_.unplacedShare / 16777216.0 : 1.0;
    double before = 0.0;
    for (size_t i = placed; i < tree_.entries.size(); ++i) {
      const double upTo = (double{tree_.entries[i].bits} + 1.0) / 4294967296.0;
      p[tree_.entries[i].light] = unplaced * (upTo - before);
      before = upTo;
    }
    if (placed > 0) descend(tile, 1, 0, 1.0 - unplaced, p);
    return p;
  }

 private:
  double worth(const TileBoxes& tile, size_t node) const {
    const scene::LightNode& n = tree_.nodes[node];
    return importance(tile, {n.low, n.high}, n.power);
  }
  void descend(const TileBoxes& tile, size_t node, uint32_t level, double probability, std::vector<double>& p) const {
    if (level == tree_.levels) {
      const uint32_t first = tree_.nodes[node].lights & ((1u << scene::kLeafShift) - 1),
                     count = tree_.nodes[node].lights >> scene::kLeafShift;
      std::vector<double> worths;
      double sum = 0.0;
      for (uint32_t i = first; i < first + count; ++i) {
        const double radius = std::bit_cast<float>(tree_.entries[i].bits);
        const glm::dvec3 centre(tree_.lights[i].centre);
        worths.push_back(importance(tile, {centre - radius, centre + radius}, tree_.lights[i].power));
        sum += worths.back();
      }
      for (uint32_t i = 0; i < count && sum > 0.0; ++i)
        p[tree_.entries[first + i].light] = probability * worths[i] / sum;
      return;
    }
    const double one = worth(tile, 2 * node), two = worth(tile, 2 * node + 1);
    if (!(one + two > 0.0)) return;
    // Neither child that is worth anything gets less than a part in 2²⁴.
    double share = one / (one + two);
    if (one > 0.0) share = std::max(share, 0x1p-24);
    if (two > 0.0) share = std::min(share, 1.0 - 0x1p-24);
    if (share > 0.0) descend(tile, 2 * node, level + 1, probability * share, p);
    if (share < 1.0) descend(tile, 2 * node + 1, level + 1, probability * (1.0 - share), p);
  }

  const scene::LightTree& tree_;
};

}  // namespace weir::test
