#include <weir/scene/tangent_space.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <tuple>
#include <unordered_map>

namespace weir::scene {
namespace {

constexpr uint32_t kNone = 0xffffffffu;

bool finite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// The part of v in the plane of n, unit length; zero where there is none.
glm::dvec3 inPlane(const glm::dvec3& v, const glm::dvec3& n) {
  const glm::dvec3 flat = v - n * glm::dot(n, v);
  const double length = glm::length(flat);
  return length > 0.0 && std::isfinite(length) ? flat / length : glm::dvec3(0.0);
}

/// What decides that two corners are one: position, normal, texture coordinates, by value.
struct Corner {
  std::array<float, 8> values;
  bool operator==(const Corner&) const = default;
};
struct CornerHash {
  size_t operator()(const Corner& corner) const {
    uint64_t hash = 0xcbf29ce484222325ull;
    // + 0: both zeros are the same value, and must be the same bits here.
    for (float value : corner.values) hash = (hash ^ std::bit_cast<uint32_t>(value + 0.0f)) * 0x9e3779b97f4a7c15ull;
    return hash ^ (hash >> 32);
  }
};

struct Triangle {
  std::array<uint32_t, 3> corner;                          // welded
  std::array<uint32_t, 3> neighbour{kNone, kNone, kNone};  // across the edge from corner k to the next one
  std::array<uint32_t, 3> group{kNone, kNone, kNone};
  glm::dvec3 alongU{0.0};   // unit length, in the direction of growing U
  bool preserves = false;   // texture coordinates turn the way the positions do
  bool joinsAny = false;    // has no direction of its own: joins whatever frame is beside it
  bool degenerate = false;  // takes no part
};

/// One frame: the triangles around a vertex that share it.
struct Group {
  uint32_t corner;
  bool preserves;
  glm::dvec3 sum{0.0};
};

class TangentSpace {
 public:
  TangentSpace(std::span<const glm::vec3> positions, std::span<const glm::vec3> normals, std::span<const glm::vec2> uvs,
               std::span<const uint32_t> indices)
      : positions_(positions), normals_(normals), uvs_(uvs), indices_(indices), triangles_(indices.size() / 3) {}

  std::vector<glm::vec4> run() {
    weld();
    for (uint32_t t = 0; t < triangles_.size(); ++t) measure(t);
    connect();
    for (uint32_t t = 0; t < triangles_.size(); ++t)
      if (!triangles_[t].degenerate && !triangles_[t].joinsAny)
        for (int k = 0; k < 3; ++k)
          if (triangles_[t].group[k] == kNone) grow(t, k);
    for (uint32_t t = 0; t < triangles_.size(); ++t)
      for (int k = 0; k < 3; ++k) contribute(t, k);

    std::vector<glm::vec4> result(indices_.size());
    for (uint32_t t = 0; t < triangles_.size(); ++t)
      for (int k = 0; k < 3; ++k) result[3 * size_t{t} + k] = tangent(t, k);
    return result;
  }

 private:
  glm::dvec3 position(uint32_t t, int k) const { return positions_[indices_[3 * size_t{t} + k]]; }
  glm::dvec2 uv(uint32_t t, int k) const {
    return uvs_.empty() ? glm::dvec2(0.0) : glm::dvec2(uvs_[indices_[3 * size_t{t} + k]]);
  }
  glm::dvec3 normal(uint32_t t, int k) const {
    if (!normals_.empty()) return normals_[indices_[3 * size_t{t} + k]];
    const glm::dvec3 face = glm::cross(position(t, 1) - position(t, 0), position(t, 2) - position(t, 0));
    const double length = glm::length(face);
    return length > 0.0 && std::isfinite(length) ? face / length : glm::dvec3(0.0, 0.0, 1.0);
  }

  void weld() {
    std::unordered_map<Corner, uint32_t, CornerHash> seen;
    seen.reserve(positions_.size());
    const auto number = [&](uint32_t t, int k) {
      const glm::vec3 p = positions_[indices_[3 * size_t{t} + k]], n(normal(t, k));
      const glm::vec2 c(uv(t, k));
      return seen.try_emplace({{p.x, p.y, p.z, n.x, n.y, n.z, c.x, c.y}}, static_cast<uint32_t>(seen.size()))
          .first->second;
    };
    // With normals of its own a vertex is the same in all its triangles, and is looked up once.
    std::vector<uint32_t> known(normals_.empty() ? 0 : positions_.size(), kNone);
    for (uint32_t t = 0; t < triangles_.size(); ++t)
      for (int k = 0; k < 3; ++k) {
        if (normals_.empty()) {
          triangles_[t].corner[k] = number(t, k);
          continue;
        }
        uint32_t& vertex = known[indices_[3 * size_t{t} + k]];
        if (vertex == kNone) vertex = number(t, k);
        triangles_[t].corner[k] = vertex;
      }
  }

  void measure(uint32_t t) {
    Triangle& triangle = triangles_[t];
    const glm::dvec3 p0 = position(t, 0), e1 = position(t, 1) - p0, e2 = position(t, 2) - p0;
    const glm::dvec2 c0 = uv(t, 0), d1 = uv(t, 1) - c0, d2 = uv(t, 2) - c0;
    const glm::dvec3 p1 = position(t, 1), p2 = position(t, 2);
    triangle.degenerate = p0 == p1 || p1 == p2 || p2 == p0 || !finite(e1) || !finite(e2);
    if (triangle.degenerate) return;
    // Texture coordinates of glTF go down the image, the method's go up: V changes its sign.
    const double area = -(d1.x * d2.y - d2.x * d1.y);
    const glm::dvec3 alongU = e2 * d1.y - e1 * d2.y, alongV = e2 * d1.x - e1 * d2.x;
    triangle.preserves = area > 0.0;
    const double length = glm::length(alongU);
    triangle.joinsAny = area == 0.0 || !(length > 0.0) || !(glm::length(alongV) > 0.0) || !std::isfinite(length);
    if (!triangle.joinsAny) triangle.alongU = alongU * ((triangle.preserves ? 1.0 : -1.0) / length);
  }

  /// Pairs triangles over edges that they run through in opposite directions. Where more than two meet, those that come
  /// first in the file are paired.
  void connect() {
    struct Edge {
      uint32_t low, high, triangle;
      uint8_t side;
      bool forward;
    };
    std::vector<Edge> edges;
    edges.reserve(indices_.size());
    for (uint32_t t = 0; t < triangles_.size(); ++t) {
      if (triangles_[t].degenerate) continue;
      for (uint8_t k = 0; k < 3; ++k) {
        const uint32_t a = triangles_[t].corner[k], b = triangles_[t].corner[(k + 1) % 3];
        edges.push_back({std::min(a, b), std::max(a, b), t, k, a < b});
      }
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
      return std::tie(a.low, a.high, a.triangle, a.side) < std::tie(b.low, b.high, b.triangle, b.side);
    });
    // Edges of one pair of corners that wait for a partner, by the direction that the partner must have.
    struct Waiting {
      std::vector<size_t> edges;
      size_t first = 0;
    };
    std::array<Waiting, 2> waiting;
    for (size_t i = 0; i < edges.size(); ++i) {
      const Edge& edge = edges[i];
      if (i == 0 || edges[i - 1].low != edge.low || edges[i - 1].high != edge.high)
        for (Waiting& list : waiting) list = {};
      Waiting& partners = waiting[edge.forward ? 1 : 0];
      if (partners.first == partners.edges.size()) {
        waiting[edge.forward ? 0 : 1].edges.push_back(i);
        continue;
      }
      const Edge& other = edges[partners.edges[partners.first++]];
      triangles_[edge.triangle].neighbour[edge.side] = other.triangle;
      triangles_[other.triangle].neighbour[other.side] = edge.triangle;
    }
  }

  /// A new group from corner k of triangle t, and everything around that vertex that belongs to it.
  void grow(uint32_t t, int k) {
    const auto number = static_cast<uint32_t>(groups_.size());
    groups_.push_back({triangles_[t].corner[k], triangles_[t].preserves});
    const Group group = groups_.back();
    std::vector<uint32_t> stack{t};
    while (!stack.empty()) {
      Triangle& triangle = triangles_[stack.back()];
      stack.pop_back();
      const auto at = std::find(triangle.corner.begin(), triangle.corner.end(), group.corner) - triangle.corner.begin();
      if (at == 3 || triangle.group[at] != kNone) continue;
      // The first frame that reaches a triangle without a direction decides which way it turns.
      if (triangle.joinsAny && triangle.group == std::array<uint32_t, 3>{kNone, kNone, kNone})
        triangle.preserves = group.preserves;
      if (triangle.preserves != group.preserves) continue;
      triangle.group[at] = number;
      // The edges that meet at the corner; pushed so that the one which leaves it is followed first.
      for (const auto side : {(at + 2) % 3, at})
        if (triangle.neighbour[side] != kNone) stack.push_back(triangle.neighbour[side]);
    }
  }

  void contribute(uint32_t t, int k) {
    const Triangle& triangle = triangles_[t];
    if (triangle.group[k] == kNone || triangle.joinsAny) return;
    const glm::dvec3 n = normal(t, k), here = position(t, k);
    const glm::dvec3 toNext = inPlane(position(t, (k + 1) % 3) - here, n),
                     toLast = inPlane(position(t, (k + 2) % 3) - here, n);
    const double angle = std::acos(std::clamp(glm::dot(toNext, toLast), -1.0, 1.0));
    groups_[triangle.group[k]].sum += inPlane(triangle.alongU, n) * angle;
  }

  glm::vec4 tangent(uint32_t t, int k) const {
    const uint32_t number = triangles_[t].group[k];
    const glm::dvec3 n = normal(t, k);
    const glm::dvec3 mean = number == kNone ? glm::dvec3(0.0) : inPlane(groups_[number].sum, n);
    const float sign = number == kNone || groups_[number].preserves ? 1.0f : -1.0f;
    return {glm::vec3(mean == glm::dvec3(0.0) ? anyOrthogonal(n) : mean), sign};
  }

  std::span<const glm::vec3> positions_, normals_;
  std::span<const glm::vec2> uvs_;
  std::span<const uint32_t> indices_;
  std::vector<Triangle> triangles_;
  std::vector<Group> groups_;
};

}  // namespace

glm::dvec3 anyOrthogonal(const glm::dvec3& n) {
  const glm::dvec3 axis = std::abs(n.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  return glm::normalize(glm::cross(n, axis));
}

std::vector<glm::vec4> cornerTangents(std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                                      std::span<const glm::vec2> uvs, std::span<const uint32_t> indices) {
  return TangentSpace(positions, normals, uvs, indices).run();
}

}  // namespace weir::scene
