// Weir's pictures on the device against the oracle's: scenes read twice, by two readers, and lit twice.
//
// What a tile must show: |mean - oracle| <= t · (both standard errors) + tolerance · oracle, t Student's with restarts
// - 1 degrees of freedom, 1 % of false alarms for all tiles of a scene; seeds are fixed, so that what passed once
// passes again on the same device. The tolerance is for what the device does with few bits and the oracle doesn't:
//   0.1 %  colours of surfaces in 10 and 11 bits (docs/architecture.md), normals in 2 x 16
//   0.5 %  textured scenes: levels of detail and interpolation in 8 bits, where single pixels differ by some per cent
//   1 %    the same on a nearly smooth surface with a normal map, where single pixels differ by 15 %
// `resolves` is the bias of half of the tiles that a test of this size finds: it grows when somebody saves on samples.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>

#include "comparison.h"
#include "device_picture.h"
#include "path.h"

namespace weir::oracle {
namespace {

constexpr uint32_t kTile = 16;
constexpr double kPlain = 0.001, kTextured = 0.005, kNearSmooth = 0.01;

struct Effort {
  uint32_t restarts, samples;       ///< of the device; paths a pixel in each restart
  uint32_t oracleSamples, batches;  ///< of the oracle
  double resolves;                  ///< relative bias of a tile
};
constexpr Effort kNoChance{4, 1, 1, 2, 0.012};
/// Where a path's one light sample among hundreds of points near surfaces is too rough for a test of seconds:
/// docs/oracle.md, "Long runs".
constexpr Effort kTooRough{0, 0, 0, 0, 0};

/// Changes the JSON of a scene before both read it.
using Edit = void (*)(Json&);

struct Case {
  const char* name;
  const char* scene;  ///< "scenes/…" is in the source tree, anything else among the large ones
  uint32_t lights = 0;
  bool replaceLights = false;
  const char* camera = "";
  const char* clip = "";
  double time = 0;
  uint32_t side = 48;
  uint32_t strata = 2;  ///< of AllLights: strata² samples of each triangle
  uint32_t bounces = 4;
  Effort direct{32, 1, 16, 16, 0.02}, paths{16, 16, 16, 16, 0.05};
  bool directByPaths = false;
  Edit edit = nullptr;
  double tolerance = kPlain;
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

/// A .glb with its JSON edited.
std::string edited(const std::string& file, Edit edit, const test::TemporaryFolder& folder) {
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  const auto word = [](size_t v) { return std::string{char(v), char(v >> 8), char(v >> 16), char(v >> 24)}; };
  uint32_t length = 0;
  std::memcpy(&length, bytes.data() + 12, 4);
  Json json = Json::parse(bytes.substr(20, length));
  edit(json);
  std::string text = json.dump();
  text.append((4 - text.size() % 4) % 4, ' ');
  const std::string rest = bytes.substr(20 + length);
  return folder.write(
      "edited.glb", "glTF" + word(2) + word(20 + text.size() + rest.size()) + word(text.size()) + "JSON" + text + rest);
}

/// Walls that let a tenth through, a lamp that is there by half and shines to both sides, one wall with a specular
/// colour, one unlit.
void mixMaterials(Json& json) {
  for (Json& m : json["materials"]) {
    if (m["name"] == "white" || m["name"] == "lamp") {
      m["alphaMode"] = "BLEND";
      m["pbrMetallicRoughness"]["baseColorFactor"][3] = m["name"] == "white" ? 0.9 : 0.5;
    }
    if (m["name"] == "lamp") m["doubleSided"] = true;
    if (m["name"] == "red") {
      m["pbrMetallicRoughness"]["roughnessFactor"] = 0.4;
      m["extensions"]["KHR_materials_ior"]["ior"] = 1.8;
      // A third of F90 is one of the 64 steps that surfaces keep of it.
      m["extensions"]["KHR_materials_specular"] = {{"specularFactor", 1.0 / 3.0},
                                                   {"specularColorFactor", {1.0, 0.5, 0.2}}};
    }
    if (m["name"] == "green") m["extensions"]["KHR_materials_unlit"] = Json::object();
  }
}

class OracleAgreement : public ::testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    file_ = sceneFile(GetParam());
    if (file_.empty()) GTEST_SKIP();
    const Case& c = GetParam();
    if (c.edit != nullptr) file_ = edited(file_, c.edit, folder_);
    render::StageOptions stage;
    stage.scene = file_;
    stage.lights = c.lights;
    stage.replaceLights = c.replaceLights;
    stage.camera = c.camera;
    stage.animate = *c.clip != 0;
    stage.clip = c.clip;
    stage.time = c.time;
    stage.timeStep = 0;
    stage_ = stage;
    std::optional<Moment> moment;
    if (stage.animate) moment = {c.clip, c.time};
    model_ = loadModel(file_, moment);
    if (c.lights > 0) generateLights(model_, c.lights, 1);
    camera_ = chooseCamera(model_, c.camera);
    tracer_.emplace(model_);
  }

  image::RestartAccumulator oracle(uint32_t bounces, const Effort& effort) const {
    return render(model_, *tracer_, camera_,
                  {.width = GetParam().side,
                   .height = GetParam().side,
                   .bounces = bounces,
                   .samples = effort.oracleSamples,
                   .batches = effort.batches,
                   .everyPunctual = bounces == 0,
                   .tile = kTile});
  }

  static std::string samplesOf(const Effort& effort) { return fmt::format("path.samples={}", effort.samples); }

  void expectAgreement(const std::string& what, const image::RestartAccumulator& device,
                       const image::RestartAccumulator& truth, double resolves) const {
    const image::Picture mean = truth.mean(), error = truth.standardError();
    EXPECT_EQ(device.nonFinite(), 0u);
    EXPECT_EQ(truth.nonFinite(), 0u);
    const Verdict v = compare(image::tileTest(device.tiles(), mean, &error), GetParam().tolerance);
    std::cout << GetParam().name << ", " << what << ": " << v.text() << "\n";
    EXPECT_TRUE(v.passed) << what << ": " << v.text();
    EXPECT_LT(v.detectable, resolves) << what << ": " << v.text();
  }

  test::TemporaryFolder folder_;
  std::string file_;
  render::StageOptions stage_;
  Model model_;
  Camera camera_;
  std::optional<Tracer> tracer_;
};

/// Both readers found the same camera and as many lights.
TEST_P(OracleAgreement, Reading) {
  const render::Stage stage = render::makeStage(stage_, 1.0f);
  const scene::Camera& c = stage.camera;
  EXPECT_LT(glm::distance(glm::dvec3(c.eye), camera_.eye), 1e-6 * (1 + glm::length(camera_.eye)));
  EXPECT_LT(glm::distance(glm::dvec3(c.forward), camera_.forward), 1e-6);
  EXPECT_LT(glm::distance(glm::dvec3(c.up), camera_.up), 1e-6);
  EXPECT_NEAR(c.verticalFov, camera_.verticalFov, 1e-6);
  const std::vector<scene::PunctualLight>& lights = stage.scene.lights;
  ASSERT_EQ(lights.size(), model_.lights.size());
  for (size_t i = 0; i < lights.size(); ++i) {
    const PunctualLight& l = model_.lights[i];
    EXPECT_LT(glm::distance(glm::dvec3(lights[i].position), l.position), 1e-5 * (1 + glm::length(l.position)));
    EXPECT_LT(glm::distance(glm::dvec3(lights[i].intensity), l.intensity), 1e-5 * glm::length(l.intensity));
  }
}

/// reference.AllLights, and reference.PathTracer without bounces.
TEST_P(OracleAgreement, DirectLight) {
  const Case& c = GetParam();
  const image::RestartAccumulator truth = oracle(0, c.direct);
  DevicePicture device(stage_);
  const std::string strata = fmt::format("direct.samples={}", c.strata);
  const auto all = device.render("all_lights.json", {strata}, c.side, c.direct.restarts, kTile);
  expectAgreement("AllLights", all, truth, c.direct.resolves);
  if (!c.directByPaths) return;
  const auto paths =
      device.render("reference.json", {"path.maxBounces=0", samplesOf(c.paths)}, c.side, c.paths.restarts, kTile);
  expectAgreement("PathTracer, 0 bounces", paths, truth, c.paths.resolves);
}

/// reference.PathTracer with bounces.
TEST_P(OracleAgreement, FullTransport) {
  const Case& c = GetParam();
  if (c.paths.restarts == 0) GTEST_SKIP() << "too rough for seconds: a long run of the program oracle";
  DevicePicture device(stage_);
  const auto paths = device.render("reference.json", {fmt::format("path.maxBounces={}", c.bounces), samplesOf(c.paths)},
                                   c.side, c.paths.restarts, kTile);
  expectAgreement(fmt::format("PathTracer, {} bounces", c.bounces), paths, oracle(c.bounces, c.paths),
                  c.paths.resolves);
}

// Cameras of the Cornell boxes look a little aslant: from the middle, the edges of the room pass through the centres of
// pixels, where it is rounding that says which wall is seen.
constexpr const char* kAslant = "0.03,0.98,3.7,0.01,1.03,0,39";

const Case kCases[] = {
    {.name = "Cornell", .scene = "scenes/cornell.glb", .camera = kAslant, .directByPaths = true},
    // Direct light without chance on either side, as punctual lights are: the tolerance is all there is.
    {.name = "CornellPoints",
     .scene = "scenes/cornell-1000-points.glb",
     .camera = kAslant,
     .side = 32,
     .strata = 1,
     .direct = kNoChance,
     .paths = {16, 16, 8, 16, 0.12}},
    {.name = "Materials", .scene = "scenes/materials.glb", .direct = {32, 1, 32, 16, 0.02}, .directByPaths = true},
    {.name = "AlphaMask", .scene = "scenes/alpha-mask.glb", .directByPaths = true, .tolerance = kTextured},
    {.name = "CornellMoving",
     .scene = "scenes/cornell-moving.glb",
     .camera = kAslant,
     .clip = "everything",
     .time = 0.7,
     .directByPaths = true},
    {.name = "CornellMixed",
     .scene = "scenes/cornell.glb",
     .camera = kAslant,
     .direct = {32, 1, 32, 16, 0.05},
     .paths = {16, 16, 32, 16, 0.15},
     .directByPaths = true,
     .edit = mixMaterials,
     .tolerance = kTextured},
    {.name = "Sponza",
     .scene = "sponza/sponza.glb",
     .lights = 500,
     .camera = "-8,2,0.3,4,3,-0.2,60",
     .side = 32,
     .strata = 1,
     .direct = kNoChance,
     .paths = kTooRough,
     .tolerance = kTextured},
    {.name = "ModernHall",
     .scene = "modern-hall/modern-hall.glb",
     .side = 32,
     .strata = 1,
     .direct = {16, 1, 64, 32, 0.05},
     .paths = {16, 16, 32, 16, 0.15},
     .tolerance = kTextured},
    // In the room that is seen there is no direct light at all; what comes through the gap of the door is rare.
    {.name = "VeachAjar",
     .scene = "veach-ajar/veach-ajar.glb",
     .bounces = 6,
     .direct = {4, 1, 1, 2, 0.02},
     .paths = {16, 16, 32, 16, 0.3},
     .tolerance = kTextured},
    {.name = "RoughnessSpheres",
     .scene = "roughness-spheres/roughness-spheres.glb",
     .lights = 30,
     .camera = "14,2,3,0,0,0,50",
     .strata = 1,
     .direct = kNoChance,
     .paths = kTooRough,
     .tolerance = kTextured},
    {.name = "SpherePunctualLights",
     .scene = "sphere-punctual-lights/sphere-punctual-lights.glb",
     .camera = "1,2,3,0,0,0,40",
     .strata = 1,
     .direct = kNoChance,
     .paths = {16, 16, 2, 16, 0.2},
     .tolerance = kTextured},
    {.name = "MetalRoughSpheres",
     .scene = "metal-rough-spheres/metal-rough-spheres.glb",
     .lights = 100,
     .camera = "0.12,0.05,0.4,0.1,0.03,0,30",
     .strata = 1,
     .direct = kNoChance,
     .paths = kTooRough,
     .tolerance = kTextured},
    {.name = "BoomBoxSpecularGlossiness",
     .scene = "boombox-spec-gloss/boombox-spec-gloss.glb",
     .lights = 50,
     .replaceLights = true,
     .camera = "0.002,0.003,-0.013,0.001,0.001,0,15",
     .strata = 1,
     .direct = kNoChance,
     .paths = {16, 16, 16, 16, 0.2},
     .tolerance = kNearSmooth},
};

INSTANTIATE_TEST_SUITE_P(Scenes, OracleAgreement, ::testing::ValuesIn(kCases),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace weir::oracle
