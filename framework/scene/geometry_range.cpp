#include <weir/scene/geometry_range.h>
#include <weir/scene/packing.h>
#include <weir/scene/spatial_sort.h>

#include <cmath>

namespace weir::scene {
namespace {

constexpr uint32_t kNone = 0xffffffffu;

bool finite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

glm::dvec3 anyOrthogonal(const glm::dvec3& n) {
  const glm::dvec3 axis = std::abs(n.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  return glm::normalize(glm::cross(n, axis));
}

glm::vec3 normaliseOr(const glm::dvec3& v, const glm::vec3& otherwise) {
  const double length = glm::length(v);
  return length > 0.0 && std::isfinite(length) ? glm::vec3(v / length) : otherwise;
}

}  // namespace

glm::vec4 tangentFromUvs(const glm::vec3 (&p)[3], const glm::vec2 (&uv)[3], const glm::vec3& normal) {
  const glm::dvec3 n(normal), e1 = glm::dvec3(p[1]) - glm::dvec3(p[0]), e2 = glm::dvec3(p[2]) - glm::dvec3(p[0]);
  const glm::dvec2 d1 = glm::dvec2(uv[1]) - glm::dvec2(uv[0]), d2 = glm::dvec2(uv[2]) - glm::dvec2(uv[0]);
  const double det = d1.x * d2.y - d2.x * d1.y;
  const double sign = det < 0.0 ? -1.0 : 1.0;
  const glm::dvec3 alongU = (e1 * d2.y - e2 * d1.y) * sign;
  const glm::dvec3 alongV = (e2 * d1.x - e1 * d2.x) * sign;
  const glm::dvec3 flat = alongU - n * glm::dot(n, alongU);
  const double length = glm::length(flat);
  if (det == 0.0 || !(length > 0.0) || !std::isfinite(length)) return {glm::vec3(anyOrthogonal(n)), 1.0f};
  const glm::dvec3 t = flat / length;
  return {glm::vec3(t), glm::dot(glm::cross(n, t), alongV) <= 0.0 ? 1.0f : -1.0f};
}

bool GeometryRange::hasArea(const uint32_t (&v)[3]) const {
  const glm::dvec3 a(positions_[v[0]]), b(positions_[v[1]]), c(positions_[v[2]]);
  const glm::dvec3 twice = glm::cross(b - a, c - a);
  if (deforms_) return finite(a) && finite(b) && finite(c);
  // In double, products of float differences can neither overflow nor, above 1e-23 m, vanish.
  const double area = 0.5 * glm::length(twice);
  return finite(twice) && area > 0.0 && std::isfinite(static_cast<float>(area));
}

uint32_t GeometryRange::addVertex(const glm::vec3& position, const glm::vec3& normal, const glm::vec4& tangent,
                                  const glm::vec2& uv, uint32_t source) {
  sources_.push_back({primitives_, source});
  positions_.push_back(position);
  vertices_.push_back({packNormal(normal), packTangent(tangent), uv.x, uv.y});
  return static_cast<uint32_t>(positions_.size() - 1);
}

void GeometryRange::add(const Primitive& primitive, uint32_t material, const glm::dmat4& transform) {
  const glm::dmat3 linear(transform);
  const double det = glm::determinant(linear);
  const bool mirrors = det < 0.0;
  // The cofactor matrix is det times the inverse transpose; it exists for flattening transforms too.
  const glm::dmat3 cofactor =
      glm::dmat3(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]), glm::cross(linear[0], linear[1])) *
      (mirrors ? -1.0 : 1.0);
  const size_t count = primitive.positions.size();
  const bool smooth = primitive.normals.size() == count;
  const bool wantsTangents = materials_[material].normalTexture >= 0;
  const bool givenTangents = smooth && primitive.tangents.size() == count;
  const auto uvOf = [&](uint32_t i) { return primitive.uv0.empty() ? glm::vec2(0.0f) : primitive.uv0[i]; };

  // First one vertex each; splitting, where needed, adds more behind them. What ends up unused goes in finish().
  const uint32_t base = static_cast<uint32_t>(positions_.size());
  positions_.reserve(positions_.size() + count);
  vertices_.reserve(vertices_.size() + count);
  std::vector<glm::vec3> normals(smooth ? count : 0);
  for (uint32_t i = 0; i < count; ++i) {
    const glm::vec3 position(transform * glm::dvec4(glm::dvec3(primitive.positions[i]), 1.0));
    glm::vec3 normal(0.0f, 0.0f, 1.0f);
    glm::vec4 tangent(0.0f, 0.0f, 1.0f, 1.0f);
    if (smooth) normals[i] = normal = normaliseOr(cofactor * glm::dvec3(primitive.normals[i]), primitive.normals[i]);
    if (wantsTangents && givenTangents) {
      const glm::dvec3 n(normal), along = linear * glm::dvec3(primitive.tangents[i]);
      tangent = {normaliseOr(along - n * glm::dot(n, along), glm::vec3(anyOrthogonal(n))),
                 mirrors ? -primitive.tangents[i].w : primitive.tangents[i].w};
    }
    addVertex(position, normal, tangent, uvOf(i), i);
  }

  const bool split = !smooth || (wantsTangents && !givenTangents);
  struct Split {
    uint32_t vertex, next;
  };
  std::vector<Split> splits;
  std::vector<uint32_t> firstSplit(split ? count : 0, kNone);
  triangles_.reserve(triangles_.size() + primitive.indices.size() / 3);
  for (size_t t = 0; t + 2 < primitive.indices.size(); t += 3) {
    // Under a mirroring transform the order of the corners is turned, so that front faces stay counter-clockwise.
    const uint32_t local[3] = {primitive.indices[t], primitive.indices[t + (mirrors ? 2 : 1)],
                               primitive.indices[t + (mirrors ? 1 : 2)]};
    PackedTriangle triangle{{base + local[0], base + local[1], base + local[2]}, material};
    if (!hasArea(triangle.v)) {
      ++dropped_;
      continue;
    }
    if (split) {
      const glm::vec3 p[3] = {positions_[triangle.v[0]], positions_[triangle.v[1]], positions_[triangle.v[2]]};
      const glm::vec2 uv[3] = {uvOf(local[0]), uvOf(local[1]), uvOf(local[2])};
      const glm::vec3 face =
          normaliseOr(glm::cross(glm::dvec3(p[1]) - glm::dvec3(p[0]), glm::dvec3(p[2]) - glm::dvec3(p[0])), {0, 0, 1});
      for (int k = 0; k < 3; ++k) {
        const glm::vec3 normal = smooth ? normals[local[k]] : face;
        const glm::vec4 tangent = wantsTangents ? tangentFromUvs(p, uv, normal) : glm::vec4(0.0f, 0.0f, 1.0f, 1.0f);
        const uint32_t packedNormal = packNormal(normal), packedTangent = packTangent(tangent);
        // Corners that agree after packing share a vertex.
        uint32_t at = deforms_ && !smooth ? kNone : firstSplit[local[k]];
        while (at != kNone && (vertices_[splits[at].vertex].normal != packedNormal ||
                               vertices_[splits[at].vertex].tangent != packedTangent))
          at = splits[at].next;
        if (at == kNone) {
          at = static_cast<uint32_t>(splits.size());
          splits.push_back({addVertex(p[k], normal, tangent, uv[k], local[k]), firstSplit[local[k]]});
          firstSplit[local[k]] = at;
        }
        triangle.v[k] = splits[at].vertex;
      }
    }
    triangles_.push_back(triangle);
  }
  ++primitives_;
}

void GeometryRange::finish(PreparedScene& scene, std::vector<VertexSource>* sources) {
  TriangleRange range;
  range.first = static_cast<uint32_t>(scene.triangles.size());
  const uint32_t base = static_cast<uint32_t>(scene.positions.size());
  std::vector<uint32_t> renumbered(positions_.size(), kNone);
  scene.triangles.reserve(scene.triangles.size() + triangles_.size());
  for (const bool masked : {false, true}) {
    std::vector<SortItem> items;
    for (uint32_t t = 0; t < triangles_.size(); ++t) {
      const PackedTriangle& triangle = triangles_[t];
      if (((materials_[triangle.material].flags & (kMaterialMask | kMaterialBlend)) != 0) != masked) continue;
      const glm::vec3 &a = positions_[triangle.v[0]], &b = positions_[triangle.v[1]], &c = positions_[triangle.v[2]];
      items.push_back({glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c)), t});
    }
    spatialSort(items);
    (masked ? range.masked : range.opaque) = static_cast<uint32_t>(items.size());
    for (const SortItem& item : items) {
      PackedTriangle triangle = triangles_[item.index];
      for (uint32_t& v : triangle.v) {
        uint32_t& now = renumbered[v];
        if (now == kNone) {
          now = static_cast<uint32_t>(scene.positions.size()) - base;
          scene.positions.push_back(positions_[v]);
          scene.vertices.push_back(vertices_[v]);
          if (sources != nullptr) sources->push_back(sources_[v]);
        }
        v = base + now;
      }
      scene.triangles.push_back(triangle);
    }
  }
  scene.ranges.push_back(range);
  scene.droppedTriangles += dropped_;
  primitives_ = 0;
  sources_.clear();
  positions_.clear();
  vertices_.clear();
  triangles_.clear();
  dropped_ = 0;
}

}  // namespace weir::scene
