// What ReSTIR's passes ought to compute, in double precision and from the sources: glTF 2.0 appendix B with Heitz
// 2014's height-correlated shadowing, KHR_lights_punctual, Bitterli et al. 2020 (RIS), Lin et al. 2022 (pairwise MIS).
// Shares with the shaders only the layouts of passes/common/layouts.h and framework/scene/lights.h.
#pragma once

#include <weir/scene/prepared.h>

#include <array>
#include <glm/glm.hpp>
#include <random>
#include <vector>

#include "common/layouts.h"

namespace weir::test::oracle {

using Vec = glm::dvec3;
using Random = std::mt19937_64;

double luminance(const Vec& c);

/// What a pixel sees, as the shader finds it after unpacking.
struct Surface {
  Vec position{0.0}, geometric{0.0}, normal{0.0}, view{0.0}, diffuse{0.0}, f0{0.0};
  double roughness = 1.0, distance = 0.0;
};

/// From the layout's bits: octahedral normals (Cigolle et al. 2014), square-root spaced albedo.
Vec normalOf(uint32_t bits);
Vec albedoOf(uint32_t bits);
uint32_t albedoBits(const Vec& albedo);

/// Unit direction through a point of the picture, in pixels from the top left.
Vec direction(const scene::Camera& camera, double x, double y, uint32_t width, uint32_t height);
Surface unpack(const passes::PackedSurface& packed, uint32_t x, uint32_t y, const scene::Camera& camera, uint32_t width,
               uint32_t height);

/// BSDF times cosine. Lights below the geometric or the shading horizon give nothing.
Vec bsdfCos(const Surface& surface, const Vec& towardsLight);

/// A place on a triangle from a reservoir's 32 bits: barycentrics of vertices 1 and 2, uniform by area (Osada et al.
/// 2002).
glm::dvec2 barycentrics(uint32_t place);
glm::dvec2 barycentrics(double u, double v);

/// What arrives from a point on a light without anything in between: per m² for triangles.
struct Arriving {
  Vec direction{0.0}, radiance{0.0}, target{0.0};
};

class World {
 public:
  World() = default;
  explicit World(const scene::PreparedScene& prepared);

  const std::vector<scene::GpuLight>& lights() const { return lights_; }
  bool isTriangle(uint32_t light) const;
  double area(uint32_t light) const;  ///< 1 for punctual lights
  Arriving arriving(uint32_t light, const glm::dvec2& barycentrics, const Vec& position) const;
  /// BSDF · cosine · radiance · geometry, unshadowed.
  Vec contribution(const Surface& surface, uint32_t light, uint32_t place) const;
  double target(const Surface& surface, uint32_t light, uint32_t place) const;
  /// What part of the light comes through the triangles between: 0 behind an opaque one, 1 - alpha for each that blends
  /// (untextured). Both ends are left out by 1e-5 of the distance.
  double transmittance(const Vec& from, const Vec& to) const;
  bool visible(const Vec& from, const Vec& to) const { return transmittance(from, to) > 0.0; }
  double transmittance(const Surface& surface, uint32_t light, uint32_t place) const;
  bool sees(const Surface& surface, uint32_t light, uint32_t place) const;
  /// Luminance of the direct light by every light: midpoints of strata² cells on each triangle.
  double directLight(const Surface& surface, bool shadows, int strata = 32) const;
  /// A fresh reservoir of confidence c by RIS over lights that are picked uniformly; hidden samples become null when
  /// asked.
  passes::Reservoir sample(const Surface& surface, Random& random, int candidates, bool visibility,
                           double confidence = 1.0) const;

 private:
  std::vector<scene::GpuLight> lights_;
  std::vector<std::array<Vec, 3>> triangles_;
  std::vector<double> through_;  ///< 1 - alpha of each
};

/// One input of a merge. `targets[j]` is p̂_j of this input's sample at the surface of input j, with its visibility
/// there where the weights ask for it (j = 0: without); all zero and weight 0 for a null sample. Input 0 is the merging
/// pixel's own.
struct MergeInput {
  double confidence = 0.0, weight = 0.0;
  std::vector<double> targets;
};
struct Merged {
  double sum = 0.0;                 ///< of the weights that samples are chosen by
  std::vector<double> probability;  ///< that input i survives
  std::vector<double> weight;       ///< W if it does; 0: what comes out is a null sample
  double confidence = 0.0;
};
constexpr double kZThreshold = 0.01;  ///< what the passes have by default
enum class Mis { Biased, Z, Balance, Pairwise };
constexpr Mis kEveryMis[] = {Mis::Biased, Mis::Z, Mis::Balance, Mis::Pairwise};
constexpr Mis kUnbiasedMis[] = {Mis::Z, Mis::Balance, Mis::Pairwise};
const char* nameOf(Mis mis);  ///< as the passes' parameter has it
/// m_i(x_i), with which W_i counts: Bitterli et al. 2020 (biased, z with the threshold above), Talbot et al. 2005
/// (balance), Lin et al. 2022 (pairwise), each with confidence weights. All but the first sum to one over the domains
/// that contain a sample.
double misWeight(const std::vector<MergeInput>& inputs, size_t i, Mis mis);
/// The merge. By z samples are chosen by c_i p̂_0(x_i) W_i, what was chosen has its Z divided out; else by m_i p̂_0 W_i.
Merged merge(const std::vector<MergeInput>& inputs, Mis mis);

}  // namespace weir::test::oracle
