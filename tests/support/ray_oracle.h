// What a ray meets and what is there, in double precision over the prepared triangles, by brute force and from the
// papers: Möller and Trumbore 1997, the material models of glTF 2.0 and its extensions. Slow, and shares no code with
// the shaders.
#pragma once

#include <weir/scene/prepared.h>

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "support/texture_oracle.h"

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
  double roughness = 0.0, f90 = 1.0;
};

/// How the level of a texture follows from what a pixel covers of it; Zero: it doesn't.
enum class LevelRule : uint8_t {
  Zero,
  Cone,         ///< Akenine-Möller et al. 2021, with the root of the pixel's solid angle as the cone's
  Derivatives,  ///< the pixel's area in the texture by differences, over the cosine of the tilt: its longer side
                ///< squared
};

/// Direction through a point of the picture, in pixels from the top left; unit length.
glm::dvec3 oracleDirection(const scene::Camera& camera, glm::dvec2 point, uint32_t width, uint32_t height);
/// Where a position lies in the picture, in pixels; z is the depth along the axis.
glm::dvec3 oracleProject(const scene::Camera& camera, glm::dvec3 position, uint32_t width, uint32_t height);

class RayOracle {
 public:
  RayOracle(const scene::Scene& scene, const scene::PreparedScene& prepared);

  /// Surfaces from now on are what a pixel of this camera shows of them.
  void seeThrough(const scene::Camera& camera, uint32_t width, uint32_t height, LevelRule rule);

  /// Every crossing with 0 < distance < tMax, nearest first; distances in units of `direction`.
  std::vector<OracleHit> crossings(glm::dvec3 origin, glm::dvec3 direction, double tMax = 1e300) const;
  /// The nearest one that is not masked away. `cameraSides`: backs of single-sided surfaces don't count.
  OracleHit closest(glm::dvec3 origin, glm::dvec3 direction, bool cameraSides) const;
  /// Π (1 - coverage) over all crossings.
  double transmittance(glm::dvec3 origin, glm::dvec3 direction, double tMax) const;

  /// Alpha of glTF: 0 or 1 for MASK, the alpha itself for BLEND, 1 for OPAQUE.
  double coverage(const OracleHit& hit) const;
  OracleSurface surface(const OracleHit& hit, glm::dvec3 direction) const;
  /// Level of a texture of PreparedScene::textures for a hit along `direction`.
  double level(int32_t index, const OracleHit& hit, glm::dvec3 direction) const;
  const scene::PackedMaterial& material(const OracleHit& hit) const;

 private:
  glm::dvec2 uv(int32_t index, uint32_t triangle, glm::dvec2 barycentrics) const;
  glm::dvec4 look(int32_t index, const OracleHit& hit, double level) const;
  glm::dvec4 color(const OracleHit& hit) const;
  std::array<glm::dvec3, 3> corners(const OracleHit& hit) const;
  void reflect(const OracleHit& hit, glm::dvec3 direction, glm::dvec3 base, OracleSurface& s) const;

  struct Triangle {
    glm::dvec3 p, e1, e2;
    uint32_t triangle, instance;
    bool flips;
  };
  const scene::Scene& scene_;
  const scene::PreparedScene& prepared_;
  std::vector<Triangle> triangles_;
  TextureOracle textures_;
  scene::Camera camera_;
  uint32_t width_ = 1, height_ = 1;
  LevelRule rule_ = LevelRule::Zero;
};

}  // namespace weir::test
