// Every unbiased combination of MIS weights, visibility and reuse against brute force, and the biased ones found out.
#include <gtest/gtest.h>

#include "laboratory.h"
#include "setup.h"
#include "support/small_scenes.h"

namespace weir::test {
namespace {

/// A floor and a wall that meet in a corner, a glossy block that stands out, a lamp and points, a post that throws
/// shadows, and a pane that lets half through. All is near enough to all that reuse goes across every edge.
scene::Scene corner() {
  Builder b;
  scene::Material grey, glossy, lamp, pane;
  grey.baseColor = {0.7f, 0.6f, 0.5f, 1.0f};
  grey.metallic = 0.0f;
  glossy.baseColor = {0.8f, 0.7f, 0.4f, 1.0f};
  glossy.roughness = 0.45f;
  lamp.emission = {9.0f, 8.0f, 6.0f};
  pane.baseColor = {0.9f, 0.9f, 1.0f, 0.5f};
  pane.alphaMode = scene::AlphaMode::Blend;
  pane.doubleSided = true;
  pane.metallic = 0.0f;
  const int greyOne = b.material(grey), glossyOne = b.material(glossy), lampOne = b.material(lamp),
            paneOne = b.material(pane);
  b.add(quad({-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}, greyOne));
  b.add(quad({-2, 0, -2}, {2, 0, -2}, {2, 3, -2}, {-2, 3, -2}, greyOne));
  // The block: front and top.
  b.add(quad({0.2f, 0, -0.5f}, {1.4f, 0, -0.2f}, {1.4f, 1, -0.2f}, {0.2f, 1, -0.5f}, glossyOne));
  b.add(quad({0.2f, 1, -0.5f}, {1.4f, 1, -0.2f}, {1.4f, 1, -1.4f}, {0.2f, 1, -1.4f}, glossyOne));
  // The post and the pane hang above the floor, out of sight of nothing.
  b.add(quad({-0.9f, 0.6f, 0.4f}, {-0.5f, 0.6f, 0.4f}, {-0.5f, 1.6f, 0.1f}, {-0.9f, 1.6f, 0.1f}, greyOne));
  b.add(quad({-0.4f, 1.3f, 1.2f}, {0.9f, 1.3f, 1.2f}, {0.9f, 1.3f, 0.2f}, {-0.4f, 1.3f, 0.2f}, paneOne));
  // Faces down, out of the camera's sight: what is seen directly is no estimator's.
  b.add(quad({-1.2f, 2.4f, -0.6f}, {-0.4f, 2.4f, -0.6f}, {-0.4f, 2.4f, 0.2f}, {-1.2f, 2.4f, 0.2f}, lampOne));
  for (int i = 0; i < 5; ++i) {
    scene::PunctualLight light;
    light.position = {-1.6f + 0.8f * static_cast<float>(i), 1.9f - 0.2f * static_cast<float>(i % 3),
                      1.4f - 0.5f * static_cast<float>(i % 2)};
    light.intensity = glm::vec3(1.5f, 1.0f + 0.4f * static_cast<float>(i), 1.2f);
    b.scene.lights.push_back(light);
  }
  b.scene.cameras.push_back(lookAt({0.3f, 1.6f, 4.0f}, {0, 0.7f, -0.6f}, 38.0f));
  return b.scene;
}

enum class Visibility { Rays, Late, Tested };

/// Everything reuses across everything; few candidates, so that reuse matters.
Protocol protocol(const char* mis, Visibility visibility, const std::vector<std::string>& disable, int iterations) {
  Protocol p;
  p.set = {"gbuffer.jitter=true", "initial.candidates=4", "temporal.confidenceCap=4",
           "spatial.radius=8",    "spatial.neighbours=3", "spatial.iterations=" + std::to_string(iterations)};
  for (const std::string pass : {"temporal", "spatial"}) {
    for (const std::string& setting :
         {std::string("mis=") + mis, std::string("depthThreshold=10"), std::string("normalThreshold=180"),
          std::string("visibilityRays=") + (visibility == Visibility::Rays ? "true" : "false")})
      p.set.push_back(pass + "." + setting);
  }
  if (visibility == Visibility::Late) p.set.emplace_back("initial.visibility=false");
  p.disable = disable;
  p.restarts = 24;
  p.frames = 3;
  return p;
}

struct Reuse {
  const char* name;
  std::vector<std::string> disable;
  int iterations;
};
const Reuse kReuses[] = {{"temporal", {"spatial"}, 1}, {"spatial twice", {"temporal"}, 2}, {"both", {}, 1}};

// Chance of a false alarm: 1e-3 for all tiles of all combinations, and as much for all means.
TEST(RestirModes, UnbiasedCombinations) {
  Laboratory laboratory(corner(), 32, 8);
  laboratory.measureTruth("3", 48, 8);
  for (const oracle::Mis mis : oracle::kUnbiasedMis) {
    for (const Visibility visibility : {Visibility::Rays, Visibility::Late}) {
      for (const Reuse& reuse : kReuses) {
        SCOPED_TRACE(testing::Message() << oracle::nameOf(mis)
                                        << (visibility == Visibility::Rays ? ", rays, " : ", late, ") << reuse.name);
        const image::TileTest t =
            laboratory.test(protocol(oracle::nameOf(mis), visibility, reuse.disable, reuse.iterations), 1e-3 / 18);
        std::printf("%-8s %s %-13s |t| %.2f of %.2f, bias %+.2f %% (%+.2f ... %+.2f)\n", oracle::nameOf(mis),
                    visibility == Visibility::Rays ? "rays" : "late", reuse.name, t.worstT, t.bound,
                    100 * t.relativeBias, 100 * t.intervalLow, 100 * t.intervalHigh);
        expectAgreement(t, 0.08);
      }
    }
  }
}

// The power of the above: by confidence alone, and with samples that were tested but weights that don't know of it, the
// picture is too dark. Chance to miss it: next to nothing.
TEST(RestirModes, BiasedCombinationsAreFound) {
  Laboratory laboratory(corner(), 32, 8);
  laboratory.measureTruth("3", 48, 8);
  const struct {
    const char* mis;
    Visibility visibility;
  } settings[] = {{"biased", Visibility::Rays},
                  {"biased", Visibility::Late},
                  {"z", Visibility::Tested},
                  {"balance", Visibility::Tested},
                  {"pairwise", Visibility::Tested}};
  for (const auto& s : settings) {
    const image::TileTest t = laboratory.test(protocol(s.mis, s.visibility, {}, 1), 1e-3);
    EXPECT_LT(t.intervalHigh, 0.0) << s.mis;
    EXPECT_FALSE(t.passed) << s.mis;
  }
}

}  // namespace
}  // namespace weir::test
