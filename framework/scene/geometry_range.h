// Gathers primitives into one range of packed triangles. Internal to scene/prepare.
#pragma once

#include <weir/scene/prepared.h>

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace weir::scene {

/// The vertex of the n-th added primitive that a packed one came from.
struct VertexSource {
  uint32_t primitive = 0, vertex = 0;
};

/// Triangles that will share an acceleration structure, in the space that the transforms given to add() lead to.
class GeometryRange {
 public:
  /// `scene` has its materials and traits; a primitive's own index into the packed materials is `material`.
  /// `deforms`: the vertices will move. Triangles that have no area yet are kept, and those without stored normals
  /// share no vertices, so that each can have a normal of its own in every frame.
  explicit GeometryRange(const PreparedScene& scene, bool deforms = false)
      : scene_(scene), materials_(scene.materials), deforms_(deforms) {}

  /// Transforms and packs a primitive. Drops triangles without area (in exact terms: their doubled area vector is zero
  /// or not a finite float) and counts them. `cornerTangents`: those of tangent_space.h, in the primitive's space, for
  /// a primitive that has none of its own and whose material needs them; else empty.
  void add(const Primitive& primitive, uint32_t material, const glm::dmat4& transform,
           std::span<const glm::vec4> cornerTangents);

  /// Sorts opaque and alpha-tested triangles apart and spatially, renumbers vertices in order of first use, and
  /// appends everything to the scene as its next range. The range is empty afterwards. `sources`, if given, gets where
  /// each appended vertex came from.
  void finish(PreparedScene& scene, std::vector<VertexSource>* sources = nullptr);

  uint64_t dropped() const { return dropped_; }

 private:
  bool hasArea(const uint32_t (&v)[3]) const;
  uint32_t addVertex(const glm::vec3& position, const glm::vec3& normal, const glm::vec4& tangent, const glm::vec2& uv,
                     uint32_t source);
  /// The parts of vertex i that only some scenes have; call it after addVertex().
  void addExtras(const Primitive& primitive, uint32_t i);

  const PreparedScene& scene_;
  const std::vector<PackedMaterial>& materials_;
  bool deforms_;
  uint32_t primitives_ = 0;  // added so far
  std::vector<VertexSource> sources_;
  std::vector<glm::vec3> positions_;
  std::vector<PackedVertex> vertices_;
  std::vector<PackedColor> colors_;  // beside vertices_ where the scene has them
  std::vector<glm::vec2> uvs1_;      // likewise
  std::vector<PackedTriangle> triangles_;
  uint64_t dropped_ = 0;
};

}  // namespace weir::scene
