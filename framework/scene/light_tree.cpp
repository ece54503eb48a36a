#include <weir/core/error.h>
#include <weir/core/parallel.h>
#include <weir/scene/light_tree.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>

namespace weir::scene {
namespace {

constexpr uint32_t kSerialLevels = 8;  // below them each subtree is one piece of work

/// A light on its way to its leaf.
struct Item {
  glm::vec3 centre;
  uint32_t light;
};

struct Corners {
  glm::vec3 low, high;
};

Corners cornersOf(const GpuLight& light) {
  if ((light.kind & 0xffu) != static_cast<uint32_t>(GpuLightKind::Triangle)) return {light.position, light.position};
  const glm::vec3 one = light.position + light.a, two = light.position + light.b;
  return {glm::min(light.position, glm::min(one, two)), glm::max(light.position, glm::max(one, two))};
}

glm::vec3 centreOf(const GpuLight& light) {
  if ((light.kind & 0xffu) != static_cast<uint32_t>(GpuLightKind::Triangle)) return light.position;
  return light.position + (light.a + light.b) / 3.0f;
}

/// Of a sphere around the centre, rounded up, that holds the corners as shaders rebuild them.
float radiusOf(const GpuLight& light, const glm::vec3& centre) {
  if ((light.kind & 0xffu) != static_cast<uint32_t>(GpuLightKind::Triangle)) return 0.0f;
  double radius = 0.0;
  for (const glm::vec3& corner : {light.position, light.position + light.a, light.position + light.b})
    radius = std::max(radius, glm::length(glm::dvec3(corner) - glm::dvec3(centre)));
  return static_cast<float>(radius * (1.0 + 0x1p-20));
}

float unitOf(const Bounds& bounds, const Corners& lights) {
  double longest = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    double low = lights.low[axis], high = lights.high[axis];
    if (!bounds.empty) {
      low = std::min(low, double{bounds.low[axis]});
      high = std::max(high, double{bounds.high[axis]});
    }
    longest = std::max(longest, high - low);
  }
  if (!(longest > 0.0)) return 1.0f;
  return static_cast<float>(std::ldexp(1.0, std::clamp(-1 - std::ilogb(longest), -126, 126)));
}

/// 10 bits of LightNode::half, rounded up.
uint32_t halfBits(double half) {
  constexpr uint32_t kShift = 18, kMost = 1023, kLeast = 97u << 23;  // 2⁻³⁰
  auto rounded = static_cast<float>(half);
  if (rounded < half) rounded = std::nextafter(rounded, std::numeric_limits<float>::infinity());
  const auto bits = std::bit_cast<uint32_t>(std::max(rounded, 0x1p-30f));
  return std::min((bits - kLeast + (1u << kShift) - 1) >> kShift, kMost);
}

LightNode packNode(const LightTree& tree, const Corners& box, float power) {
  constexpr int kBits[3] = {21, 21, 22};
  // More than the rounding of a surface's place in tree units.
  constexpr double kMargin = 0x1p-21;
  uint32_t place[3] = {0, 0, 0};
  LightNode node;
  node.power = power;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = (double{box.low[axis]} - tree.origin[axis]) * tree.unit;
    const double high = (double{box.high[axis]} - tree.origin[axis]) * tree.unit;
    const double steps = std::ldexp(1.0, kBits[axis]);
    place[axis] = static_cast<uint32_t>(std::clamp(std::round((low + high) / 2 * steps), 0.0, steps - 1.0));
    const double middle = place[axis] / steps;
    node.half |= halfBits(std::max(high - middle, middle - low) + kMargin) << (10 * axis);
  }
  node.place[0] = (place[0] << 11) | (place[2] >> 11);
  node.place[1] = (place[1] << 11) | (place[2] & 0x7ffu);
  return node;
}

class Builder {
 public:
  Builder(std::span<const GpuLight> lights, std::vector<Item> items, LightTree& tree)
      : lights_(lights), items_(std::move(items)), tree_(tree), leaves_(uint64_t{1} << tree.levels) {
    // A light whose float of a probability is next to nothing must be found all the same.
    leastPower_ = 0x1p-24f / static_cast<float>(lights.size());
  }

  void run(const Bounds& bounds) {
    tree_.nodes.resize(2 * leaves_);
    tree_.entries.resize(items_.size());
    boxes_.resize(2 * leaves_);
    const uint32_t serial = std::min(tree_.levels, kSerialLevels);
    for (uint32_t level = 0; level < serial; ++level)
      parallelFor(size_t{1} << level, [&](size_t i) { split((size_t{1} << level) + i, level); });
    parallelFor(size_t{1} << serial, [&](size_t i) { build((size_t{1} << serial) + i, serial); });
    for (size_t node = (size_t{1} << serial) - 1; node > 0; --node) join(node);
    tree_.origin = boxes_[1].low;
    tree_.unit = unitOf(bounds, boxes_[1]);
    for (size_t node = 1; node < tree_.nodes.size(); ++node)
      tree_.nodes[node] = packNode(tree_, boxes_[node], tree_.nodes[node].power);
  }

 private:
  std::span<Item> itemsUnder(uint64_t node, uint32_t level) {
    const uint32_t below = tree_.levels - level;
    const uint64_t first = (node - (uint64_t{1} << level)) << below;
    const uint64_t begin = tree_.firstOf(first), end = tree_.firstOf(first + (uint64_t{1} << below));
    return std::span(items_).subspan(begin, end - begin);
  }

  /// Puts the items of a node's first child before those of the second, along the longest side of their centres' box.
  void split(uint64_t node, uint32_t level) {
    const std::span<Item> items = itemsUnder(node, level);
    const size_t half = itemsUnder(2 * node, level + 1).size();
    if (items.empty() || half == 0 || half == items.size()) return;
    Corners box{items[0].centre, items[0].centre};
    for (const Item& item : items) {
      box.low = glm::min(box.low, item.centre);
      box.high = glm::max(box.high, item.centre);
    }
    const glm::dvec3 sides = glm::dvec3(box.high) - glm::dvec3(box.low);
    int axis = sides.y > sides.x ? 1 : 0;
    if (sides.z > sides[axis]) axis = 2;
    // Ties by number: the same tree on every machine.
    std::nth_element(items.begin(), items.begin() + static_cast<ptrdiff_t>(half), items.end(),
                     [axis](const Item& a, const Item& b) {
                       return a.centre[axis] != b.centre[axis] ? a.centre[axis] < b.centre[axis] : a.light < b.light;
                     });
  }

  void build(uint64_t node, uint32_t level) {
    if (level == tree_.levels) return fill(node, level);
    split(node, level);
    build(2 * node, level + 1);
    build(2 * node + 1, level + 1);
    join(node);
  }

  void fill(uint64_t node, uint32_t level) {
    const std::span<const Item> items = itemsUnder(node, level);
    const auto first = static_cast<uint32_t>(items.data() - items_.data());
    Corners& all = boxes_[node];
    double power = 0.0;
    for (size_t i = 0; i < items.size(); ++i) {
      const GpuLight& light = lights_[items[i].light];
      const Corners box = cornersOf(light);
      all.low = i == 0 ? box.low : glm::min(all.low, box.low);
      all.high = i == 0 ? box.high : glm::max(all.high, box.high);
      PlacedLight& placed = tree_.lights[first + i];
      placed = {items[i].centre, std::max(light.pdf, leastPower_)};
      power += placed.power;
      tree_.entries[first + i] = {items[i].light, std::bit_cast<uint32_t>(radiusOf(light, placed.centre))};
    }
    tree_.nodes[node].power = static_cast<float>(power);
  }

  void join(uint64_t node) {
    if (node >= leaves_) return;
    const Corners &one = boxes_[2 * node], &two = boxes_[2 * node + 1];
    boxes_[node] = {glm::min(one.low, two.low), glm::max(one.high, two.high)};
    tree_.nodes[node].power = tree_.nodes[2 * node].power + tree_.nodes[2 * node + 1].power;
  }

  std::span<const GpuLight> lights_;
  std::vector<Item> items_;
  std::vector<Corners> boxes_;  // of the nodes
  LightTree& tree_;
  uint64_t leaves_;
  float leastPower_ = 0.0f;
};

/// Numbers out of 2³² for each of the lights without a place, in proportion to their powers and at least one each.
void addUnplaced(std::span<const GpuLight> lights, const std::vector<uint32_t>& unplaced, LightTree& tree) {
  double sum = 0.0, most = 0.0;
  for (const uint32_t light : unplaced) {
    sum += lights[light].pdf;
    most = std::max(most, double{lights[light].pdf});
  }
  const uint64_t all = uint64_t{1} << 32;
  const auto numbersOf = [&](uint32_t light) {
    const auto spare = static_cast<double>(all - unplaced.size());
    return 1 + (sum > 0.0 ? static_cast<uint64_t>(lights[light].pdf / sum * spare * (1.0 - 0x1p-40)) : 0);
  };
  uint64_t given = 0;
  for (const uint32_t light : unplaced) given += numbersOf(light);
  uint64_t rest = all - given, next = 0;  // what rounding down left goes to the brightest
  for (const uint32_t light : unplaced) {
    next += numbersOf(light);
    if (double{lights[light].pdf} == most) {
      next += rest;
      rest = 0;
    }
    tree.entries.push_back({light, static_cast<uint32_t>(next - 1)});
  }
}

}  // namespace

bool hasPlace(const GpuLight& light) {
  const auto kind = static_cast<GpuLightKind>(light.kind & 0xffu);
  return kind != GpuLightKind::Directional && kind != GpuLightKind::Environment;
}

LightTree buildLightTree(std::span<const GpuLight> lights, const Bounds& bounds) {
  std::vector<Item> items;
  std::vector<uint32_t> unplaced;
  items.reserve(lights.size());
  double power = 0.0, unplacedPower = 0.0;
  for (size_t i = 0; i < lights.size(); ++i) {
    power += lights[i].pdf;
    if (!hasPlace(lights[i])) {
      unplacedPower += lights[i].pdf;
      unplaced.push_back(static_cast<uint32_t>(i));
      continue;
    }
    const Corners box = cornersOf(lights[i]);
    const glm::vec3 centre = centreOf(lights[i]);
    for (const glm::vec3& v : {box.low, box.high, centre})
      if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z))
        throw InputError("light " + std::to_string(i) + " is not in a finite place, and can't be picked by it");
    items.push_back({centre, static_cast<uint32_t>(i)});
  }
  if (items.size() > LightTree::kMostLights)
    throw InputError(std::to_string(items.size()) + " lights are more than can be picked by place; expected at most " +
                     std::to_string(LightTree::kMostLights));
  LightTree tree;
  if (items.empty()) {
    tree.nodes.resize(2);
    tree.unplacedShare = unplaced.empty() ? 0 : 1u << 24;
  } else {
    // Up to the cut leaves are free: they stop at one or two lights.
    while ((items.size() - 1) >> tree.levels >= LightTree::kMostInLeaf ||
           (tree.levels < LightTree::kMostCutLevels && items.size() >> (tree.levels + 1) > 0))
      ++tree.levels;
    tree.cutLevels = tree.levels;
    while (tree.cutLevels > LightTree::kMostCutLevels) tree.cutLevels -= 2;
    if (!unplaced.empty()) {
      const double share = power > 0.0 ? std::clamp(unplacedPower / power, 0.25, 0.75) : 0.5;
      tree.unplacedShare = static_cast<uint32_t>(share * 0x1p24);
    }
    tree.lights.resize(items.size());
    Builder(lights, std::move(items), tree).run(bounds);
  }
  addUnplaced(lights, unplaced, tree);
  return tree;
}

}  // namespace weir::scene
