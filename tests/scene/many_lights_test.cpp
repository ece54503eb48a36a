// A mesh of more than a million emissive triangles: prepared in seconds, every triangle a light with its share.
#include <sys/resource.h>

#include <cmath>
#include <ctime>

#include "scene_support.h"
#include "support/small_scenes.h"

namespace weir::scene::test {
namespace {

/// A waving sheet of 2 · side² triangles, all of which shine; triangles grow with x, so that powers differ.
Scene shiningSheet(uint32_t side) {
  weir::test::Builder b;
  Material m;
  m.emission = glm::vec3(3, 2, 1);
  Primitive p;
  for (uint32_t y = 0; y <= side; ++y) {
    for (uint32_t x = 0; x <= side; ++x) {
      const float u = static_cast<float>(x) / static_cast<float>(side),
                  v = static_cast<float>(y) / static_cast<float>(side);
      p.positions.emplace_back(10 * u * u + 10 * u, std::sin(20 * u) * std::cos(15 * v), 20 * v);
    }
  }
  const uint32_t row = side + 1;
  p.indices.reserve(size_t{6} * side * side);
  for (uint32_t y = 0; y < side; ++y) {
    for (uint32_t x = 0; x < side; ++x) {
      const uint32_t a = y * row + x;
      p.indices.insert(p.indices.end(), {a, a + row, a + row + 1, a, a + row + 1, a + 1});
    }
  }
  p.material = b.material(m);
  b.add(std::move(p));
  return std::move(b.scene);
}

TEST(ManyLights, AMillionEmissiveTriangles) {
  constexpr uint32_t kLights = 1'201'250;  // 2 · 775²
  const Scene scene = shiningSheet(775);
  const std::clock_t start = std::clock();  // processor time: what else runs on the machine doesn't matter
  const PreparedScene p = prepareScene(scene);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  RecordProperty("seconds", std::to_string(seconds));
  RecordProperty("peak_mebibytes", std::to_string(usage.ru_maxrss / 1024));
  std::cout << "prepared in " << seconds << " s of processor time, peak of the process " << usage.ru_maxrss / 1024
            << " MiB\n";
  EXPECT_LT(seconds, 30.0);
  EXPECT_LT(usage.ru_maxrss / 1024, 1024) << "MiB";

  ASSERT_EQ(p.lights.size(), kLights);
  ASSERT_EQ(p.aliasTable.size(), kLights);
  EXPECT_EQ(p.triangleLights, kLights);
  // The highest bit of a reservoir's light says that it was seen.
  EXPECT_LT(p.lights.size(), size_t{1} << 31);
  double sum = 0.0, area = 0.0;
  for (const GpuLight& light : p.lights) area += light.area;
  for (size_t i = 0; i < kLights; ++i) {
    const GpuLight& light = p.lights[i];
    ASSERT_LT(light.triangle, p.triangles.size());
    ASSERT_LT(p.aliasTable[i].alias, kLights);
    ASSERT_NEAR(light.pdf * area / light.area, 1.0, 2e-4) << i;
    sum += light.pdf;
  }
  EXPECT_NEAR(sum, 1.0, 1e-6);
}

}  // namespace
}  // namespace weir::scene::test
