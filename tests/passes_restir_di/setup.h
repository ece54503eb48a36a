// What the tests of ReSTIR's passes ask about: small scenes, surfaces written by hand, and statistics of what came
// back.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "oracle.h"
#include "support/pass_test.h"

namespace weir::test {

/// Material of a surface that a test writes.
struct Finish {
  oracle::Vec diffuse{0.5, 0.4, 0.3}, f0{0.04};
  double roughness = 0.6;
};

/// A pixel without a surface.
passes::PackedSurface nothing();
passes::PackedSurface packSurface(double distance, const oracle::Vec& geometric, const oracle::Vec& normal,
                                  const Finish& finish, uint32_t jitterX = 127, uint32_t jitterY = 127);

/// A camera at (0, 0, 5) that looks along -z; at distance 5 it sees the square |x|, |y| <= `halfSize`.
scene::Camera frontCamera(double halfSize = 2.0);

/// The surfaces of a picture: packed for the pass and unpacked for the oracle.
class View {
 public:
  View(uint32_t width, uint32_t height, const scene::Camera& camera);
  uint32_t width() const { return width_; }
  uint32_t height() const { return height_; }
  size_t pixels() const { return packed_.size(); }
  const scene::Camera& camera() const { return camera_; }
  void set(uint32_t x, uint32_t y, const passes::PackedSurface& surface);
  /// A surface where the pixel's ray meets the plane z = height.
  void setOnPlane(uint32_t x, uint32_t y, double height, const oracle::Vec& normal = {0, 0, 1},
                  const Finish& finish = {});
  const std::vector<passes::PackedSurface>& packed() const { return packed_; }
  bool has(size_t pixel) const { return packed_[pixel].distance > 0.0f; }
  const oracle::Surface& operator[](size_t pixel) const { return surfaces_[pixel]; }

 private:
  uint32_t width_, height_;
  scene::Camera camera_;
  std::vector<passes::PackedSurface> packed_;
  std::vector<oracle::Surface> surfaces_;
};

/// The whole picture on the plane z = 0, facing the camera.
View planeView(uint32_t width, uint32_t height, const scene::Camera& camera);
/// The same with a step in the middle: on the left at z = 0 and tilted to the right, on the right at z = -2 and tilted
/// to the left.
View stepView(uint32_t width, uint32_t height, const scene::Camera& camera);

/// Size, camera, surfaces and scene of a pass under test.
void show(PassTest& pass, const View& view, scene::Scene scene);

struct Lights {
  bool points = true, spot = true, quad = true, blocker = true;
  bool veil = false;  ///< a sheet that lets 40 % through, before another part of the plane
};
/// Lights of every kind in front of the plane z = 0, and a square blocker between them and a part of it.
/// The surfaces that tests write are not geometry of the scene: nothing but lights' triangles and the blocker is.
scene::Scene smallScene(const Lights& lights);
/// Only these point lights.
scene::Scene pointScene(const std::vector<std::pair<glm::vec3, glm::vec3>>& positionsAndIntensities);

/// Index of a reservoir's light without the bit that says "seen from its pixel".
inline uint32_t lightOf(const passes::Reservoir& r) {
  return r.light & 0x3fffffffu;
}
inline bool isSeen(const passes::Reservoir& r) {
  return (r.light & 0x80000000u) != 0;
}
bool isFinite(const passes::Reservoir& r);
/// Luminance of f · W, times the oracle's transmittance when asked.
double estimate(const oracle::World& world, const oracle::Surface& surface, const passes::Reservoir& r,
                bool visibility);

/// A reservoir by RIS for every pixel and sample; none has a sample or confidence where there is no surface. With
/// visibility, hidden samples are null and half of those that nothing veils say that they were seen.
std::vector<passes::Reservoir> freshReservoirs(const oracle::World& world, const View& view, oracle::Random& random,
                                               int candidates, bool visibility, double confidence = 1.0,
                                               int perPixel = 1);

/// Luminance of each pixel's direct light.
std::vector<double> directLight(const oracle::World& world, const View& view, bool shadows);

/// `count` equal point lights in one place, so that a reservoir's light can name where it came from.
scene::Scene namedLights(uint32_t count);

/// Mean and its standard error, one value at a time.
class Sample {
 public:
  void add(double value);
  uint64_t count() const { return count_; }
  double mean() const { return mean_; }
  double standardError() const;
  /// Distance of the mean from what it should be, in standard errors.
  double t(double expected) const;

 private:
  uint64_t count_ = 0;
  double mean_ = 0.0, squares_ = 0.0;
};

/// The mean is `expected`: Student's t, two-sided, chance of a false alarm `alpha` over `comparisons` calls.
testing::AssertionResult agrees(const Sample& sample, double expected, double alpha, int comparisons = 1);

/// Pearson's χ² of counts against probabilities (cells of fewer than five expected are pooled): chance that it is at
/// least this large when nothing is wrong.
double chiSquareP(const std::vector<uint64_t>& counts, const std::vector<double>& probabilities);

}  // namespace weir::test
