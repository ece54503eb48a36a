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

  /// Lights and surfaces in metres.
  double importance(const TileBoxes& tile, const Box& lights, double power) const {
    const double unit = tree_.unit;
    const Box difference{(lights.low - tile.places.high) * unit, (lights.high - tile.places.low) * unit};
    const glm::dvec3 between = (difference.low + difference.high) / 2.0, reach = difference.high - between;
    const glm::dvec3 normal = (tile.normals.low + tile.normals.high) / 2.0, spread = tile.normals.high - normal;
    // No more than this is any product of a normal and a difference.
    double height = 0.0, d2 = 0.0;
    for (int k = 0; k < 3; ++k) {
      height += normal[k] * between[k] + std::abs(normal[k]) * reach[k] + spread[k] * (std::abs(between[k]) + reach[k]);
      height += (std::abs(between[k]) + reach[k]) * 0x1p-20;
      const double middle = (lights.low[k] + lights.high[k]) / 2.0;
      d2 += std::pow((middle - std::clamp(middle, tile.places.low[k], tile.places.high[k])) * unit, 2);
      d2 += std::pow((lights.high[k] - lights.low[k]) * unit, 2) / 12.0;
      d2 += std::pow((tile.places.high[k] - tile.places.low[k]) * unit, 2) / 12.0;
    }
    if (!(height > 0.0)) return 0.0;
    d2 = std::max(d2, 0x1p-40);
    return power * std::clamp(height / std::sqrt(d2), 0x1p-24, 1.0) / d2;
  }

  /// Of a node, in metres.
  Box boxOf(size_t node) const {
    const scene::LightNode& n = tree_.nodes[node];
    const uint32_t z = (n.place[0] & 2047u) * 2048u + (n.place[1] & 2047u);
    const double unit = tree_.unit;
    const glm::dvec3 place((n.place[0] >> 11) / 2097152.0, (n.place[1] >> 11) / 2097152.0, z / 4194304.0);
    glm::dvec3 half;
    for (int k = 0; k < 3; ++k) {
      const uint32_t bits = (n.half >> (10 * k)) & 1023u;
      half[k] = std::ldexp(1.0 + (bits & 31u) / 32.0, static_cast<int>(bits >> 5) - 30);
    }
    const glm::dvec3 origin(tree_.origin);
    return {origin + (place - half) / unit, origin + (place + half) / unit};
  }

  /// By light; their sum is 1 but for what ends where nothing below a node can light the tile.
  std::vector<double> probabilities(const TileBoxes& tile, size_t lights) const {
    std::vector<double> p(lights, 0.0);
    const size_t placed = tree_.lights.size();
    std::vector<double> cut;
    double all = 0.0;
    const size_t nodes = size_t{1} << tree_.cutLevels;
    for (size_t node = nodes; node < 2 * nodes; ++node) {
      cut.push_back(placed > 0 ? worth(tile, node) : 0.0);
      all += cut.back();
    }
    double unplaced = 0.0;
    if (tree_.unplaced() > 0) unplaced = all > 0.0 ? tree_.unplacedShare / 16777216.0 : 1.0;
    double before = 0.0;
    for (size_t i = placed; i < tree_.entries.size(); ++i) {
      const double upTo = (double{tree_.entries[i].bits} + 1.0) / 4294967296.0;
      p[tree_.entries[i].light] = unplaced * (upTo - before);
      before = upTo;
    }
    const std::vector<double> shares = inParts(cut, 0x1p30);
    for (size_t i = 0; i < nodes; ++i)
      if (shares[i] > 0.0) descend(tile, nodes + i, tree_.cutLevels, (1.0 - unplaced) * shares[i], p);
    return p;
  }

 private:
  /// Shares of what is worth something, in so many whole parts, of which each has at least one: on average half a part
  /// more than its own. Empty sums have none.
  static std::vector<double> inParts(const std::vector<double>& worths, double parts) {
    double sum = 0.0, all = 0.0;
    for (const double w : worths) sum += w;
    std::vector<double> shares;
    for (const double w : worths) {
      shares.push_back(w > 0.0 ? std::max(w / sum * parts + 0.5, 1.0) : 0.0);
      all += shares.back();
    }
    for (double& share : shares) share = all > 0.0 ? share / all : 0.0;
    return shares;
  }
  double worth(const TileBoxes& tile, size_t node) const {
    return importance(tile, boxOf(node), tree_.nodes[node].power);
  }
  void descend(const TileBoxes& tile, size_t node, uint32_t level, double probability, std::vector<double>& p) const {
    std::vector<double> worths;
    if (level == tree_.levels) {
      const uint64_t leaf = node - (uint64_t{1} << level), first = tree_.firstOf(leaf);
      for (uint64_t i = first; i < tree_.firstOf(leaf + 1); ++i) {
        const double radius = std::bit_cast<float>(tree_.entries[i].bits);
        const glm::dvec3 centre(tree_.lights[i].centre);
        worths.push_back(importance(tile, {centre - radius, centre + radius}, tree_.lights[i].power));
      }
      const std::vector<double> shares = inParts(worths, 0x1p24);
      for (size_t i = 0; i < shares.size(); ++i) p[tree_.entries[first + i].light] = probability * shares[i];
      return;
    }
    for (size_t i = 0; i < 4; ++i) worths.push_back(worth(tile, 4 * node + i));
    const std::vector<double> shares = inParts(worths, 0x1p24);
    for (size_t i = 0; i < 4; ++i)
      if (shares[i] > 0.0) descend(tile, 4 * node + i, level + 2, probability * shares[i], p);
  }

  const scene::LightTree& tree_;
};

}  // namespace weir::test
