// Motion vectors against projection in double precision, and where in its pixel a surface is sampled.
#include "passes_gbuffer/gbuffer_frame.h"

namespace weir::test {
namespace {

/// Runs `before`, then `now`, and compares the second frame's motion.
void expectMotion(const scene::Scene& scene, const scene::Camera& before, const scene::Camera& now, uint32_t w,
                  uint32_t h) {
  PassTest t("gbuffer.RayTraced");
  t.size(w, h).scene(scene).camera(before);
  t.run();
  t.camera(now).run();
  const GFrame frame = readFrame(t, w, h);
  const RayOracle oracle(t.sourceScene(), t.prepared());
  size_t wrong = 0;
  for (uint32_t y = 0; y < h; ++y) {
    for (uint32_t x = 0; x < w; ++x) {
      const GPixel& p = frame.at(x, y);
      const glm::dvec2 point = glm::dvec2(x, y) + 0.5;
      const glm::dvec3 d = oracleDirection(now, point, w, h);
      // Of the surface that the pixel shows, whichever side of an edge that is; of the infinitely far where there is
      // none.
      const glm::dvec3 shown = p.distance > 0 ? glm::dvec3(now.eye) + p.distance * d : glm::dvec3(before.eye) + d;
      const glm::dvec3 was = oracleProject(before, shown, w, h);
      const glm::dvec2 expected = glm::dvec2(was) - point;
      // Close to the old camera's plane a vector of thousands of pixels has fewer digits to spare.
      const double allowed = 0.01 + 1e-5 * glm::length(expected);
      const bool fine = was.z > 1e-4    ? glm::length(p.motion - expected) <= allowed
                        : was.z < -1e-4 ? p.motion.x > 1e30
                                        : true;
      if (!fine && ++wrong <= 5) {
        ADD_FAILURE() << "pixel " << x << ", " << y << ": " << p.motion.x << ", " << p.motion.y << " instead of "
                      << expected.x << ", " << expected.y;
      }
    }
  }
  EXPECT_EQ(wrong, 0u);
  expectOracle(frame, oracle, now);
}

TEST(Motion, OfAMovingCamera) {
  const scene::Scene scene = own("cornell.glb");
  const scene::Camera a = lookAt({0, 1, 3.9f}, {0, 1, 0}, 45), b = lookAt({0.1f, 1.05f, 3.7f}, {0.05f, 0.98f, 0}, 45);
  expectMotion(scene, a, b, 64, 64);
  expectMotion(scene, b, a, 37, 21);
  expectMotion(scene, lookAt({0.2f, 1, 2}, {-0.5f, 0.7f, 0}, 70), a, 64, 40);  // also another field of view
}

TEST(Motion, OfMissesIsThatOfTheSky) {
  expectMotion(own("materials.glb"), lookAt({0, 1, 6}, {0.3f, 1.5f, 0}), lookAt({0, 1, 6}, {0, 1.4f, 0}), 48, 32);
  expectMotion({}, lookAt({5, 1, 6}, {5, 1, 0}), lookAt({0, 1, 6}, {0.5f, 1.1f, 0}), 16, 16);
}

TEST(Motion, BehindTheOldCameraIsNowhere) {
  const scene::Scene scene = own("cornell.glb");
  expectMotion(scene, lookAt({0, 1, 0.5f}, {0, 1, 5}), lookAt({0, 1, 0.5f}, {0, 1, -1}), 32, 32);
  expectMotion(scene, lookAt({0, 1, 0.5f}, {1, 1, 0.5f}), lookAt({0, 1, 0.5f}, {0, 1, -1}, 100), 32, 32);
}

TEST(Motion, IsZeroAfterACut) {
  PassTest t("gbuffer.RayTraced");
  const scene::Scene scene = own("cornell.glb");
  t.size(16, 16).scene(scene).camera(lookAt({0, 1, 3.9f}, {0, 1, 0}));
  t.run();
  t.camera(lookAt({0.5f, 1.5f, 3}, {0, 1, 0}));
  t.resetHistory();
  t.run();
  for (const GPixel& p : readFrame(t, 16, 16).pixels) EXPECT_LT(glm::length(p.motion), 1e-3);
}

// One place for all pixels of a frame, another in the next, uniform over the pixel's box: the mean of 64 frames within
// 5 σ of its middle (false alarm 6e-7 an axis; the places are the same in every run).
TEST(Jitter, MovesTheSampleAndNothingElse) {
  const scene::Scene scene = own("materials.glb");
  PassTest t("gbuffer.RayTraced");
  t.size(24, 16).scene(scene).camera(scene.cameras.at(0)).param("jitter", "true").seed(2);
  glm::dvec2 sum(0.0), squares(0.0);
  std::vector<glm::uvec2> places;
  constexpr int kFrames = 64;
  for (int f = 0; f < kFrames; ++f) {
    t.run();
    const GFrame frame = readFrame(t, 24, 16);
    for (const GPixel& p : frame.pixels) {
      if (p.distance > 0) {
        ASSERT_EQ(p.jitter, frame.at(12, 12).jitter);
        EXPECT_LT(glm::length(p.motion), 2e-3) << "a still camera moves nothing";
      } else {
        ASSERT_EQ(p.jitter, glm::uvec2(127)) << "a miss";
      }
    }
    if (f < 4) {
      const RayOracle oracle(t.sourceScene(), t.prepared());
      expectOracle(frame, oracle, scene.cameras.at(0), {}, 0.02);
    }
    const glm::uvec2 place = frame.at(12, 12).jitter;
    places.push_back(place);
    sum += jitterPlace(place);
    squares += jitterPlace(place) * jitterPlace(place);
  }
  const double sigma = std::sqrt(1.0 / 12 / kFrames);
  EXPECT_NEAR(sum.x / kFrames, 0.5, 5 * sigma);
  EXPECT_NEAR(sum.y / kFrames, 0.5, 5 * sigma);
  // Second moment of a uniform number: 1/3 with variance 4/45.
  EXPECT_NEAR(squares.x / kFrames, 1.0 / 3, 5 * std::sqrt(4.0 / 45 / kFrames));
  EXPECT_NEAR(squares.y / kFrames, 1.0 / 3, 5 * std::sqrt(4.0 / 45 / kFrames));
  std::ranges::sort(places, [](auto a, auto b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  EXPECT_GT(std::ranges::unique(places).begin() - places.begin(), kFrames - 5);
}

}  // namespace
}  // namespace weir::test
