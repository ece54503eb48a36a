// A furnace as a picture: white metal balls under a white sky vanish.
#include <gtest/gtest.h>
#include <weir/image/student.h>

#include "../../passes/common/layouts.h"
#include "support/environment_oracle.h"
#include "support/pass_test.h"
#include "support/small_scenes.h"

namespace weir::test {
namespace {

constexpr uint32_t kSide = 48, kTile = 12, kFrames = 32;

constexpr float kApart = 300;  // metres; a ball covers 3e-6 of another one's sky

/// Three balls of F0 = 1, roughness 0.2, 0.6 and 1. Facets are flat, so that no light that a shading normal faces comes
/// from below the surface.
scene::Scene balls() {
  Builder b;
  for (int i = 0; i < 3; ++i) {
    scene::Material m;
    m.metallic = 1;
    m.roughness = 0.2f + 0.4f * static_cast<float>(i);
    scene::Primitive p = sphere(16, 32, b.material(m));
    p.normals.clear();
    b.add(p, glm::mat4(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -kApart * static_cast<float>(i), 1));
  }
  b.scene.environment = environmentOf(4, 2, [](uint32_t, uint32_t) { return glm::vec3(1); });
  b.scene.energyCompensation = true;
  return b.scene;
}

// Direct light is all there is, as each ball is convex and far from the next. The mean over frames, of each tile and of
// the whole ball: frames are independent, so that Student's t with frames - 1 degrees of freedom holds; chance of a
// false alarm 1e-4 over all tiles. To its interval comes the table's error of at most 0.001.
TEST(FurnacePicture, WhiteMetalUnderAWhiteSky) {
  const scene::Scene scene = balls();
  constexpr int kTiles = 3 * ((kSide / kTile) * (kSide / kTile) + 1);
  const double bound = image::studentTBound(kFrames - 1, 1e-4, kTiles);
  PassTest eye("gbuffer.RayTraced"), t("reference.AllLights");
  eye.size(kSide, kSide).scene(scene);
  t.size(kSide, kSide).scene(scene).param("samples", "4").seed(5);
  ASSERT_TRUE(t.prepared().traits.energyCompensation);
  for (int ball = 0; ball < 3; ++ball) {
    SCOPED_TRACE(testing::Message() << "ball " << ball);
    const float z = -kApart * static_cast<float>(ball);
    const scene::Camera camera = lookAt({0.5f, 0.6f, z + 3}, {0, 0, z}, 36);
    eye.camera(camera).run();
    const auto surface = eye.output<passes::PackedSurface>("surface");
    t.camera(camera).input("surface", surface).input("emission", eye.output<glm::vec4>("emission"));
    constexpr uint32_t kAcross = kSide / kTile, kWhole = kAcross * kAcross;
    std::vector<double> sum(kWhole + 1, 0), squares(kWhole + 1, 0);
    std::vector<uint32_t> pixels(kWhole + 1, 0);
    for (uint32_t f = 0; f < kFrames; ++f) {
      t.run();
      const auto color = t.output<glm::vec4>("color");
      std::vector<double> mean(kWhole + 1, 0);
      std::ranges::fill(pixels, 0);
      for (uint32_t i = 0; i < kSide * kSide; ++i) {
        const uint32_t tile = i / kSide / kTile * kAcross + i % kSide / kTile;
        if (surface[i].distance == 0) continue;
        EXPECT_TRUE(std::isfinite(color[i].x));
        EXPECT_EQ(color[i].x, color[i].y);
        for (const uint32_t k : {tile, kWhole}) {
          mean[k] += color[i].x;
          ++pixels[k];
        }
      }
      for (size_t k = 0; k < mean.size(); ++k) {
        const double value = pixels[k] > 0 ? mean[k] / pixels[k] : 1;
        sum[k] += value - 1;
        squares[k] += (value - 1) * (value - 1);
      }
    }
    int tested = 0;
    for (size_t k = 0; k < sum.size(); ++k) {
      if (pixels[k] < kTile * kTile / 4) continue;
      ++tested;
      const double mean = sum[k] / kFrames;
      const double error = std::sqrt((squares[k] / kFrames - mean * mean) / (kFrames - 1));
      EXPECT_LE(std::abs(mean), 0.001 + bound * error) << "tile " << k;
      EXPECT_LT(error, k == kWhole ? 0.0015 : 0.006) << "too few samples to find anything";
      if (k == kWhole) std::cout << "ball " << ball << ": 1 + " << mean << " ± " << error << "\n";
    }
    EXPECT_GE(tested, 12);
  }
}

}  // namespace
}  // namespace weir::test
