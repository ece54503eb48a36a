// Cut-outs and transparency as the camera sees them.
#include "passes_gbuffer/gbuffer_frame.h"

namespace weir::test {
namespace {

TEST(Alpha, MasksAgreeWithTheTexture) {
  const scene::Scene scene = own("alpha-mask.glb");
  const scene::Camera camera = scene.cameras.at(0);
  PassTest t("gbuffer.RayTraced");
  t.size(96, 64).scene(scene).camera(camera);
  t.run();
  const GFrame frame = readFrame(t, 96, 64);
  RayOracle oracle(t.sourceScene(), t.prepared());
  oracle.seeThrough(camera, frame.width, frame.height, LevelRule::Cone);
  size_t skipped = 0, holes = 0, leaves = 0, wrong = 0;
  for (uint32_t y = 0; y < frame.height; ++y) {
    for (uint32_t x = 0; x < frame.width; ++x) {
      // Where the texture's alpha changes within a hundredth of a pixel, rounding decides.
      const auto seen = [&](glm::dvec2 shift) {
        const glm::dvec3 d = oracleDirection(camera, glm::dvec2(x, y) + 0.5 + shift, frame.width, frame.height);
        return oracle.closest(camera.eye, d, true);
      };
      const OracleHit hit = seen({0, 0});
      bool uncertain = false;
      for (const glm::dvec2 shift : {glm::dvec2(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
        uncertain |= seen(shift * 0.01).triangle != hit.triangle;
      }
      if (uncertain) {
        ++skipped;
        continue;
      }
      const glm::dvec3 d = oracleDirection(camera, glm::dvec2(x, y) + 0.5, frame.width, frame.height);
      const Tolerance textured{.root = 0.02};
      if (const std::string said = difference(frame.at(x, y), oracle, hit, d, textured);
          !said.empty() && ++wrong <= 5) {
        ADD_FAILURE() << "pixel " << x << ", " << y << ": " << said;
      }
      const auto all = oracle.crossings(camera.eye, d);
      if (!all.empty() && oracle.coverage(all.front()) == 0.0) ++holes;
      if (hit && (oracle.material(hit).flags & scene::kMaterialMask) != 0) ++leaves;
    }
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_LT(skipped, frame.pixels.size() / 20);
  EXPECT_GT(holes, 100u);  // the test sees through something, and is stopped by something
  EXPECT_GT(leaves, 100u);
}

/// Two transparent layers, each with a roughness that tells it, over an opaque one.
scene::Scene layers(float nearAlpha, float farAlpha) {
  Builder b;
  float z = 1.0f;
  for (const float alpha : {nearAlpha, farAlpha, 1.0f}) {
    scene::Material m;
    m.baseColor.a = alpha;
    m.alphaMode = alpha < 1.0f ? scene::AlphaMode::Blend : scene::AlphaMode::Opaque;
    m.roughness = z / 4;
    b.add(quad({-9, -9, -z}, {9, -9, -z}, {9, 9, -z}, {-9, 9, -z}, b.material(m)));
    z += 1.0f;
  }
  return b.scene;
}

// Shares of 64² pixels × 16 frames. Bounds are 5 σ of a binomial: false alarm 6e-7 each, and the numbers are the same
// in every run.
TEST(Alpha, BlendCoversAsOftenAsItsAlphaSays) {
  for (const char* type : {"gbuffer.RayTraced", "gbuffer.Raster"}) {
    constexpr uint32_t kSide = 64, kFrames = 16;
    constexpr double kNear = 0.3, kFar = 0.6;
    PassTest t(type);
    t.size(kSide, kSide).scene(layers(kNear, kFar)).camera(lookAt({0, 0, 0}, {0, 0, -1}));
    double count[3] = {0, 0, 0}, both = 0, right = 0;
    std::vector<bool> before;
    for (uint32_t f = 0; f < kFrames; ++f) {
      t.run();
      const GFrame frame = readFrame(t, kSide, kSide);
      std::vector<bool> near;
      for (const GPixel& p : frame.pixels) {
        const long layer = std::lround(p.roughness * 4) - 1;
        ASSERT_TRUE(layer >= 0 && layer < 3);
        count[layer] += 1;
        near.push_back(layer == 0);
      }
      for (size_t i = 0; i < near.size() && !before.empty(); ++i) both += near[i] && before[i];
      for (size_t i = 0; i + 1 < near.size(); ++i) right += near[i] && near[i + 1];
      before = near;
    }
    const auto expectShare = [&](double counted, double n, double p, const char* what) {
      EXPECT_NEAR(counted / n, p, 5 * std::sqrt(p * (1 - p) / n)) << type << ": " << what;
    };
    constexpr double kAll = double{kSide} * kSide * kFrames;
    expectShare(count[0], kAll, kNear, "the near layer");
    expectShare(count[1], kAll, (1 - kNear) * kFar, "the far layer, independent of the near one");
    expectShare(count[2], kAll, (1 - kNear) * (1 - kFar), "what is behind both");
    // Pairs overlap, which widens the spread by at most √3.
    const double n = double{kSide} * kSide * (kFrames - 1), p = kNear * kNear;
    EXPECT_NEAR(both / n, p, 5 * std::sqrt(3 * p * (1 - p) / n)) << type << ": frame after frame";
    EXPECT_NEAR(right / kAll, p, 5 * std::sqrt(3 * p * (1 - p) / kAll)) << type << ": pixel beside pixel";
  }
}

TEST(Alpha, TheCoinIsKeyedByFrameAndSeed) {
  PassTest t("gbuffer.RayTraced");
  t.size(32, 32).scene(layers(0.5f, 0.5f)).camera(lookAt({0, 0, 0}, {0, 0, -1}));
  const auto run = [&](uint32_t frame, uint32_t seed) {
    t.frame(frame).seed(seed).run();
    return t.output<uint32_t>("surface");
  };
  const auto first = run(3, 1);
  EXPECT_EQ(run(3, 1), first);
  EXPECT_NE(run(4, 1), first);
  EXPECT_NE(run(3, 2), first);
}

}  // namespace
}  // namespace weir::test
