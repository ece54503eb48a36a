// What a ray meets and what is there, in double precision over the prepared triangles, by brute force and from the
// papers: Möller and Trumbore 1997, glTF 2.0's material model and texture lookup. Slow, and shares no code with the
// shaders.
#pragma once

#include <weir/scene/prepared.h>

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace weir::test {

struct OracleHit {
  double distance = 0.0;  ///< 0: nothing
  uint32_t triangle = 0xffffffffu, instance = 0;
  glm::dvec2 barycentrics{0.0};
  bool front = false;
  explicit operator bool() const { return distance > 0.0; }
};

struct OracleSurface {
  glm::dvec3 position{0.0}, geometricNormal{0.0}, normal{0.0};  ///< both normals face the viewer
  glm::dvec3 diffuse{0.0}, f0{0.0}, emission{0.0};
  double roughness = 0.0;
};

/// Direction through a point of the picture, in pixels from the top left; unit length.
glm::dvec3 oracleDirection(const scene::Camera& camera, glm::dvec2 point, uint32_t width, uint32_t height);
/// Where a position lies in the picture, in pixels; z is the depth along the axis.
glm::dvec3 oracleProject(const scene::Camera& camera, glm::dvec3 position, uint32_t width, uint32_t height);

class RayOracle {
 public:
  RayOracle(const scene::Scene& scene, const scene::PreparedScene& prepared);

  /// Every crossing with 0 < distance < tMax, nearest first; distances in units of `direction`.
  std::vector<OracleHit> crossings(glm::dvec3 origin, glm::dvec3 direction, double tMax = 1e300) const;
  /// The nearest one that is not masked away. `cameraSides`: backs of single-sided surfaces don't count.
  OracleHit closest(glm::dvec3 origin, glm::dvec3 direction, bool cameraSides) const;
  /// Π (1 - coverage) over all crossings.
  double transmittance(glm::dvec3 origin, glm::dvec3 direction, double tMax) const;

  /// Alpha of glTF: 0 or 1 for MASK, the alpha itself for BLEND, 1 for OPAQUE.
  double coverage(const OracleHit& hit) const;
  glm::dvec2 uv(const OracleHit& hit) const;
  OracleSurface surface(const OracleHit& hit, glm::dvec3 direction) const;
  /// A texture of PreparedScene::textures, decoded from sRGB where it is.
  glm::dvec4 texture(int32_t index, glm::dvec2 uv) const;
  const scene::PackedMaterial& material(const OracleHit& hit) const;

 private:
  struct Triangle {
    glm::dvec3 p, e1, e2;
    uint32_t triangle, instance;
    bool flips;
  };
  const scene::Scene& scene_;
  const scene::PreparedScene& prepared_;
  std::vector<Triangle> triangles_;
};

}  // namespace weir::test
