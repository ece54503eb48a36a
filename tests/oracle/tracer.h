// Rays through a model: Embree finds the triangle, double precision where on it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "surface.h"

namespace weir::oracle {

constexpr uint32_t kNoTriangle = 0xffffffffu;

class Tracer {
 public:
  /// Keeps a reference to the model. Throws RuntimeError.
  explicit Tracer(const Model& model);
  ~Tracer();
  Tracer(const Tracer&) = delete;
  Tracer& operator=(const Tracer&) = delete;

  /// Nearest surface. Surfaces with BLEND are there with the probability of their alpha, by coins that `key` decides.
  /// `from`: triangle that the ray leaves (a plane can't meet itself). `camera`: backs of single-sided surfaces are
  /// hidden.
  std::optional<Hit> closest(const glm::dvec3& origin, const glm::dvec3& direction, uint64_t key,
                             uint32_t from = kNoTriangle, bool camera = false) const;
  /// Π(1 - alpha) over all surfaces between, but for the triangles `from` and `to`. `distance` may be infinite.
  double transmittance(const glm::dvec3& origin, const glm::dvec3& direction, double distance, uint32_t from,
                       uint32_t to = kNoTriangle) const;

 private:
  struct Scene;
  const Model& model_;
  std::unique_ptr<Scene> scene_;
};

/// Where rays that leave a surface start: off its plane by some units in the last place of a float, and as far back on
/// the way that led there: a point in a corner of two planes lies before both.
glm::dvec3 leave(const Surface& s);

}  // namespace weir::oracle
