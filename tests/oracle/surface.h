// From a hit to a shaded point, and the BSDF there: glTF 2.0, appendix B.
#pragma once

#include <functional>
#include <optional>

#include "model.h"

namespace weir::oracle {

struct Hit {
  uint32_t triangle = 0;
  glm::dvec3 barycentrics{1, 0, 0};
  double distance = 0;
};

/// What a camera's ray knows of its pixel: the level at which textures are read.
struct Cone {
  double angle = 0;  ///< root of the pixel's solid angle
};

struct Surface {
  glm::dvec3 position;
  glm::dvec3 geometric;  ///< unit, faces the viewer
  glm::dvec3 normal;     ///< unit shading normal
  glm::dvec3 view;       ///< unit, towards the viewer
  glm::dvec3 diffuse{0}, f0{0};
  double f90 = 1, alpha = 1;  ///< GGX α
  glm::dvec3 emission{0};     ///< towards the viewer, nit
  uint32_t triangle = 0;
  bool unlit = false;
};

/// Level 0 of textures without a cone.
Surface surfaceAt(const Model& model, const Hit& hit, const glm::dvec3& direction,
                  const std::optional<Cone>& cone = {});

/// Alpha of a triangle's point: 1 for OPAQUE, 0 or 1 for MASK, what it says for BLEND. Always level 0.
double coverageAt(const Model& model, uint32_t triangle, const glm::dvec3& barycentrics);

/// Radiance that a triangle's front emits at a point, level 0, times its coverage if it is asked for.
glm::dvec3 emissionAt(const Model& model, uint32_t triangle, const glm::dvec3& barycentrics, bool timesCoverage);

/// f · cos for light from `l`, per channel; zero below the shading or the geometric surface.
glm::dvec3 bsdfCos(const Surface& s, const glm::dvec3& l);

/// A direction for three uniform numbers: GGX by visible normals (Dupuy and Benyoub 2023) or the cosine's hemisphere.
glm::dvec3 sampleBsdf(const Surface& s, const glm::dvec3& u);
/// Its density per steradian.
double densityOfBsdf(const Surface& s, const glm::dvec3& l);

inline double luminanceOf(const glm::dvec3& c) {
  return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b;
}

}  // namespace weir::oracle
