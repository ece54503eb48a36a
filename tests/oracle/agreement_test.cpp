// Weir's pictures on the device against the oracle's: scenes read twice, by two readers, and lit twice.
//
// What a tile must show: |mean - oracle| <= t · (both standard errors) + tolerance · oracle, t Student's with restarts
// - 1 degrees of freedom, 1 % of false alarms for all tiles of a scene; seeds are fixed, so that what passed once
// passes again on the same device. The tolerance is for what the device does with few bits and the oracle doesn't:
//   0.1 %  colours of surfaces in 10 and 11 bits (docs/architecture.md), normals in 2 x 16
//   0.5 %  textured scenes: levels of detail and interpolation in 8 bits, where single pixels differ by some per cent
//   1 %    the same on a nearly smooth surface with a normal map, where single pixels differ by 15 %
// `resolves` is the bias of half of the tiles that a test of this size finds: it grows when somebody saves on samples.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <iostream>

#include "comparison.h"
#include "device_picture.h"
#include "path.h"

namespace weir::oracle {
namespace {

constexpr uint32_t kTile = 16;
constexpr double kPlain = 0.001, kTextured = 0.005, kNearSmooth = 0.01;

struct Case {
  const char* name;
  const char* scene;  ///< "scenes/…" is in the source tree, anything else among the large ones
  uint32_t lights = 0;
  bool replaceLights = false;
  const char* camera = "";
  const char* clip = "";
  double time = 0;
  // Direct light.
  uint32_t side = 48, strata = 2, restarts = 16;  ///< of the device: strata² samples of each triangle
  uint32_t samples = 16, batches = 16;            ///< of the oracle
  double tolerance = kPlain, resolves = 0.02;
};

std::ostream& operator<<(std::ostream& out, const Case& c) {
  return out << c.name;
}

/// Empty, and says so loudly, where this machine has no large scenes.
std::string sceneFile(const Case& c) {
  const std::string path = c.scene;
  if (path.starts_with("scenes/")) return test::sourcePath(path);
  const char* given = std::getenv("WEIR_SCENES");
  const std::string file = (given != nullptr ? given : test::sourcePath("../shared/scenes")) + "/" + path;
  if (std::filesystem::exists(file)) return file;
  std::cerr << "\n*** NO SCENE AT " << file << ": NOT COMPARED WITH THE ORACLE. SET WEIR_SCENES. ***\n\n";
  return {};
}

class OracleAgreement : public ::testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    file_ = sceneFile(GetParam());
    if (file_.empty()) GTEST_SKIP();
    const Case& c = GetParam();
    render::StageOptions stage;
    stage.scene = file_;
    stage.lights = c.lights;
    stage.replaceLights = c.replaceLights;
    stage.camera = c.camera;
    stage.animate = *c.clip != 0;
    stage.clip = c.clip;
    stage.time = c.time;
    stage.timeStep = 0;
    device_.emplace(stage);
    std::optional<Moment> moment;
    if (stage.animate) moment = {c.clip, c.time};
    model_ = loadModel(file_, moment);
    if (c.lights > 0) generateLights(model_, c.lights, 1);
    camera_ = chooseCamera(model_, c.camera);
    tracer_.emplace(model_);
  }

  image::RestartAccumulator oracle(uint32_t bounces, uint32_t samples, uint32_t batches) const {
    return render(model_, *tracer_, camera_,
                  {.width = GetParam().side,
                   .height = GetParam().side,
                   .bounces = bounces,
                   .samples = samples,
                   .batches = batches,
                   .everyPunctual = bounces == 0,
                   .tile = kTile});
  }

  Verdict judge(const image::RestartAccumulator& device, const image::RestartAccumulator& truth) const {
    const image::Picture mean = truth.mean(), error = truth.standardError();
    EXPECT_EQ(device.nonFinite(), 0u);
    EXPECT_EQ(truth.nonFinite(), 0u);
    const Verdict v = compare(image::tileTest(device.tiles(), mean, &error), GetParam().tolerance);
    std::cout << GetParam().name << ": " << v.text() << "\n";
    return v;
  }

  std::string file_;
  std::optional<DevicePicture> device_;
  Model model_;
  Camera camera_;
  std::optional<Tracer> tracer_;
};

/// Both readers found the same camera and as many lights.
TEST_P(OracleAgreement, Reading) {
  const scene::Camera& c = device_->stage().camera;
  EXPECT_LT(glm::distance(glm::dvec3(c.eye), camera_.eye), 1e-6 * (1 + glm::length(camera_.eye)));
  EXPECT_LT(glm::distance(glm::dvec3(c.forward), camera_.forward), 1e-6);
  EXPECT_LT(glm::distance(glm::dvec3(c.up), camera_.up), 1e-6);
  EXPECT_NEAR(c.verticalFov, camera_.verticalFov, 1e-6);
  const std::vector<scene::PunctualLight>& lights = device_->stage().scene.lights;
  ASSERT_EQ(lights.size(), model_.lights.size());
  for (size_t i = 0; i < lights.size(); ++i) {
    const PunctualLight& l = model_.lights[i];
    EXPECT_LT(glm::distance(glm::dvec3(lights[i].position), l.position), 1e-5 * (1 + glm::length(l.position)));
    EXPECT_LT(glm::distance(glm::dvec3(lights[i].intensity), l.intensity), 1e-5 * glm::length(l.intensity));
  }
}

TEST_P(OracleAgreement, DirectLight) {
  const Case& c = GetParam();
  const auto device =
      device_->render("all_lights.json", {"direct.samples=" + std::to_string(c.strata)}, c.side, c.restarts, kTile);
  const Verdict v = judge(device, oracle(0, c.samples, c.batches));
  EXPECT_TRUE(v.passed) << v.text();
  EXPECT_LT(v.detectable, c.resolves) << v.text();
}

// Cameras of the Cornell boxes look a little aslant: from the middle, the edges of the room pass through the centres of
// pixels, where it is rounding that says which wall is seen.
constexpr const char* kAslant = "0.03,0.98,3.7,0.01,1.03,0,39";

const Case kCases[] = {
    {.name = "Cornell", .scene = "scenes/cornell.glb", .camera = kAslant, .restarts = 32},
    // Without chance on either side, as punctual lights are: the tolerance is all there is.
    {.name = "CornellPoints",
     .scene = "scenes/cornell-1000-points.glb",
     .camera = kAslant,
     .side = 32,
     .strata = 1,
     .restarts = 4,
     .samples = 1,
     .batches = 2,
     .resolves = 0.0015},
    {.name = "Materials", .scene = "scenes/materials.glb", .restarts = 32, .samples = 32},
    {.name = "AlphaMask", .scene = "scenes/alpha-mask.glb", .restarts = 32, .tolerance = kTextured},
    {.name = "CornellMoving",
     .scene = "scenes/cornell-moving.glb",
     .camera = kAslant,
     .clip = "everything",
     .time = 0.7,
     .restarts = 32},
    {.name = "Sponza",
     .scene = "sponza/sponza.glb",
     .lights = 500,
     .camera = "-8,2,0.3,4,3,-0.2,60",
     .side = 32,
     .strata = 1,
     .restarts = 3,
     .samples = 1,
     .batches = 2,
     .tolerance = kTextured,
     .resolves = 0.006},
    {.name = "ModernHall",
     .scene = "modern-hall/modern-hall.glb",
     .side = 32,
     .strata = 1,
     .restarts = 16,
     .samples = 64,
     .batches = 32,
     .tolerance = kTextured,
     .resolves = 0.05},
    {.name = "RoughnessSpheres",
     .scene = "roughness-spheres/roughness-spheres.glb",
     .lights = 30,
     .camera = "14,2,3,0,0,0,50",
     .strata = 1,
     .restarts = 4,
     .samples = 1,
     .batches = 2,
     .tolerance = kTextured,
     .resolves = 0.006},
    {.name = "SpherePunctualLights",
     .scene = "sphere-punctual-lights/sphere-punctual-lights.glb",
     .camera = "1,2,3,0,0,0,40",
     .strata = 1,
     .restarts = 4,
     .samples = 1,
     .batches = 2,
     .tolerance = kTextured,
     .resolves = 0.006},
    {.name = "MetalRoughSpheres",
     .scene = "metal-rough-spheres/metal-rough-spheres.glb",
     .lights = 100,
     .camera = "0.12,0.05,0.4,0.1,0.03,0,30",
     .strata = 1,
     .restarts = 4,
     .samples = 1,
     .batches = 2,
     .tolerance = kTextured,
     .resolves = 0.006},
    {.name = "BoomBoxSpecularGlossiness",
     .scene = "boombox-spec-gloss/boombox-spec-gloss.glb",
     .lights = 50,
     .replaceLights = true,
     .camera = "0.002,0.003,-0.013,0.001,0.001,0,15",
     .strata = 1,
     .restarts = 4,
     .samples = 1,
     .batches = 2,
     .tolerance = kNearSmooth,
     .resolves = 0.011},
};

INSTANTIATE_TEST_SUITE_P(Scenes, OracleAgreement, ::testing::ValuesIn(kCases),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace weir::oracle
