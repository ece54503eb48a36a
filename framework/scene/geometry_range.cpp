#include <weir/scene/geometry_range.h>
#include <weir/scene/packing.h>
#include <weir/scene/spatial_sort.h>
#include <weir/scene/tangent_space.h>

#include <algorithm>
#include <cmath>

namespace weir::scene {
namespace {

constexpr uint32_t kNone = 0xffffffffu;
constexpr int kSplitTries = 32;

bool finite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

glm::vec3 normaliseOr(const glm::dvec3& v, const glm::vec3& otherwise) {
  const double length = glm::length(v);
  return length > 0.0 && std::isfinite(length) ? glm::vec3(v / length) : otherwise;
}

}  // namespace

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

void GeometryRange::addExtras(const Primitive& primitive, uint32_t i) {
  if (scene_.traits.vertexColors) {
    const glm::vec4 c = primitive.colors.empty() ? glm::vec4(1.0f) : primitive.colors[i];
    const glm::vec3 root = glm::sqrt(glm::max(glm::vec3(c), 0.0f));
    const auto pack = [](float low, float high) {
      const auto code = [](float v) {
        return static_cast<uint32_t>(std::lround(std::clamp(v, 0.0f, 1.0f) * 65535.0f));
      };
      return code(low) | (code(high) << 16);
    };
    colors_.push_back({pack(root.r, root.g), pack(root.b, c.a)});
  }
  if (scene_.traits.uvSets) uvs1_.push_back(primitive.uv1.empty() ? glm::vec2(0.0f) : primitive.uv1[i]);
}

void GeometryRange::add(const Primitive& primitive, uint32_t material, const glm::dmat4& transform,
                        std::span<const glm::vec4> cornerTangents) {
  const glm::dmat3 linear(transform);
  const double det = glm::determinant(linear);
  const bool mirrors = det < 0.0;
  // The cofactor matrix is det times the inverse transpose; it exists for flattening transforms too.
  const glm::dmat3 cofactor =
      glm::dmat3(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]), glm::cross(linear[0], linear[1])) *
      (mirrors ? -1.0 : 1.0);
  const size_t count = primitive.positions.size();
  const bool smooth = primitive.normals.size() == count;
  const bool givenTangents = smooth && primitive.tangents.size() == count && materials_[material].normalTexture >= 0;
  const bool splitTangents = !givenTangents && !cornerTangents.empty();
  const auto uvOf = [&](uint32_t i) { return primitive.uv0.empty() ? glm::vec2(0.0f) : primitive.uv0[i]; };

  const auto worldTangent = [&](const glm::vec4& tangent, const glm::vec3& normal) -> glm::vec4 {
    const glm::dvec3 n(normal), along = linear * glm::dvec3(tangent);
    return {normaliseOr(along - n * glm::dot(n, along), glm::vec3(anyOrthogonal(n))), mirrors ? -tangent.w : tangent.w};
  };

  // First one vertex each; splitting, where needed, adds more behind them. What ends up unused goes in finish().
  const uint32_t base = static_cast<uint32_t>(positions_.size());
  std::vector<glm::vec3> normals(smooth ? count : 0);
  for (uint32_t i = 0; i < count; ++i) {
    const glm::vec3 position(transform * glm::dvec4(glm::dvec3(primitive.positions[i]), 1.0));
    glm::vec3 normal(0.0f, 0.0f, 1.0f);
    glm::vec4 tangent(0.0f, 0.0f, 1.0f, 1.0f);
    if (smooth) normals[i] = normal = normaliseOr(cofactor * glm::dvec3(primitive.normals[i]), primitive.normals[i]);
    if (givenTangents) tangent = worldTangent(primitive.tangents[i], normal);
    addVertex(position, normal, tangent, uvOf(i), i);
    addExtras(primitive, i);
  }

  const bool split = !smooth || splitTangents;
  struct Split {
    uint32_t vertex, next;
  };
  std::vector<Split> splits;
  std::vector<uint32_t> firstSplit(split ? count : 0, kNone);
  for (size_t t = 0; t + 2 < primitive.indices.size(); t += 3) {
    // Under a mirroring transform the order of the corners is turned, so that front faces stay counter-clockwise.
    const size_t corner[3] = {t, t + (mirrors ? 2 : 1), t + (mirrors ? 1 : 2)};
    const uint32_t local[3] = {primitive.indices[corner[0]], primitive.indices[corner[1]],
                               primitive.indices[corner[2]]};
    PackedTriangle triangle{{base + local[0], base + local[1], base + local[2]}, material};
    if (!hasArea(triangle.v)) {
      ++dropped_;
      continue;
    }
    if (split) {
      const glm::vec3 p[3] = {positions_[triangle.v[0]], positions_[triangle.v[1]], positions_[triangle.v[2]]};
      const glm::vec3 face =
          normaliseOr(glm::cross(glm::dvec3(p[1]) - glm::dvec3(p[0]), glm::dvec3(p[2]) - glm::dvec3(p[0])), {0, 0, 1});
      for (int k = 0; k < 3; ++k) {
        const glm::vec3 normal = smooth ? normals[local[k]] : face;
        const glm::vec4 tangent =
            splitTangents ? worldTangent(cornerTangents[corner[k]], normal) : glm::vec4(0.0f, 0.0f, 1.0f, 1.0f);
        const uint32_t packedNormal = packNormal(normal), packedTangent = packTangent(tangent);
        // Corners that agree after packing share a vertex. Only the latest ones are asked: the hub of a fan has as many
        // as there are triangles.
        uint32_t at = deforms_ && !smooth ? kNone : firstSplit[local[k]];
        for (int tries = 0; at != kNone && (vertices_[splits[at].vertex].normal != packedNormal ||
                                            vertices_[splits[at].vertex].tangent != packedTangent);
             ++tries)
          at = tries < kSplitTries ? splits[at].next : kNone;
        if (at == kNone) {
          at = static_cast<uint32_t>(splits.size());
          splits.push_back({addVertex(p[k], normal, tangent, uvOf(local[k]), local[k]), firstSplit[local[k]]});
          addExtras(primitive, local[k]);
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
          if (!colors_.empty()) scene.colors.push_back(colors_[v]);
          if (!uvs1_.empty()) scene.uvs1.push_back(uvs1_[v]);
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
  colors_.clear();
  uvs1_.clear();
  triangles_.clear();
  dropped_ = 0;
}

}  // namespace weir::scene
