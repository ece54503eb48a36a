#include <gtest/gtest.h>
#include <weir/scene/packing.h>

#include <random>

namespace weir::scene {
namespace {

double angle(const glm::vec3& a, const glm::vec3& b) {
  return std::atan2(glm::length(glm::cross(glm::dvec3(a), glm::dvec3(b))), glm::dot(glm::dvec3(a), glm::dvec3(b)));
}

TEST(Packing, ErrorsStayInTheirBounds) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> gauss;
  double worstNormal = 0.0, worstTangent = 0.0;
  for (int i = 0; i < 1'000'000; ++i) {
    const glm::vec3 n(glm::normalize(glm::dvec3(gauss(random), gauss(random), gauss(random))));
    worstNormal = std::max(worstNormal, angle(n, unpackNormal(packNormal(n))));
    const float w = i & 1 ? -1.0f : 1.0f;
    const glm::vec4 t = unpackTangent(packTangent({n, w}));
    ASSERT_EQ(t.w, w);
    worstTangent = std::max(worstTangent, angle(n, glm::vec3(t)));
  }
  EXPECT_LT(worstNormal, 7e-5);
  EXPECT_LT(worstTangent, 1e-4);
}

TEST(Packing, AxesAreExact) {
  for (int axis = 0; axis < 3; ++axis)
    for (const float sign : {-1.0f, 1.0f}) {
      glm::vec3 n(0.0f);
      n[axis] = sign;
      EXPECT_EQ(unpackNormal(packNormal(n)), n);
      EXPECT_EQ(glm::vec3(unpackTangent(packTangent({n, -1.0f}))), n);
    }
}

TEST(Packing, BadVectorsGiveAUnitVector) {
  const float nan = std::nanf(""), infinity = INFINITY;
  for (const glm::vec3 bad : {glm::vec3(0.0f), glm::vec3(nan), glm::vec3(infinity, 0.0f, 0.0f)})
    EXPECT_EQ(unpackNormal(packNormal(bad)), glm::vec3(0.0f, 0.0f, 1.0f));
}

}  // namespace
}  // namespace weir::scene
