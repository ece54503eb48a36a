// What lights a model: punctual lights by KHR_lights_punctual, emissive triangles by area.
#pragma once

#include <vector>

#include "model.h"
#include "random.h"
#include "surface.h"

namespace weir::oracle {

/// docs/lights.md, "--lights N": N points in place of whatever lit the model.
void generateLights(Model& model, uint32_t count, uint32_t seed);

/// Light of a punctual light at a point without anything between: irradiance on a plane that faces it.
struct Arrival {
  glm::dvec3 direction{0, 1, 0};  ///< unit, towards the light
  glm::dvec3 irradiance{0};
  double distance = 0;  ///< infinite for directional ones
};
Arrival arrivalFrom(const PunctualLight& light, const glm::dvec3& position);

struct AreaSample {
  uint32_t triangle = 0;
  glm::dvec3 position, direction;
  glm::dvec3 radiance{0};  ///< alpha times emission; zero behind a single-sided one
  double distance = 0;
  double density = 0;  ///< per steradian
};

class AreaLights {
 public:
  explicit AreaLights(const Model& model);
  bool empty() const { return triangles_.empty(); }
  /// A triangle by power, a point on it by area.
  AreaSample sample(const glm::dvec3& from, Random& random) const;
  /// Density per steradian with which sample() gives this point; 0 where it never does.
  double density(const Hit& hit, const glm::dvec3& from, const glm::dvec3& direction) const;

 private:
  const Model& model_;
  std::vector<uint32_t> triangles_;
  std::vector<double> upTo_;     ///< sums of the chances, the last is 1
  std::vector<double> perArea_;  ///< per triangle of the model: chance / area, 0 for dark ones
};

}  // namespace weir::oracle
