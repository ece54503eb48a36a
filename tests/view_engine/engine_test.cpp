// What runs in the window, without one: whatever fails, what ran before goes on; and what is shown after so many frames
// is what `weir render` makes of as many.
#include <gtest/gtest.h>
#include <weir/core/error.h>
#include <weir/render/render.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "support/device.h"
#include "view/engine/engine.h"

namespace weir::view {
namespace {

using test::sourcePath;

std::string textOf(const std::string& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

class EngineTest : public ::testing::Test {
 protected:
  EngineTest() : device_(test::validatedDevice()), quiet_(*device_), registry_({test::binaryPath("bin")}) {
    stageOptions_.scene = sourcePath("scenes/cornell.glb");
    options_.graphFile = sourcePath("graphs/restir_di.json");
    options_.graphJson = textOf(options_.graphFile);
    options_.size = {24, 24};
    options_.backend = trace::chooseBackend("auto", *device_);
    engine_ = std::make_unique<Engine>(*device_, registry_, options_, stageOptions_, stage(stageOptions_));
  }
  static std::unique_ptr<render::Stage> stage(const render::StageOptions& options) {
    return std::make_unique<render::Stage>(render::makeStage(options, 1.0f));
  }
  void frames(int count) {
    for (int i = 0; i < count; ++i) engine_->advance(std::nullopt);
    engine_->executor().finish();
  }
  image::Picture shown() { return engine_->executor().read("radiance"); }
  /// The same by `weir render`.
  image::Picture rendered(const std::string& graph, uint32_t count) const {
    const test::TemporaryFolder folder;
    render::RenderOptions o;
    o.graph = graph;
    o.stage = stageOptions_;
    o.width = o.height = 24;
    o.frames = count;
    o.device = test::deviceChoice();
    o.pluginPaths = {test::binaryPath("bin")};
    o.outputs = {{"radiance", folder.path() + "/radiance.exr"}};
    render::render(o);
    return image::readExr(folder.path() + "/radiance.exr");
  }

  std::shared_ptr<gpu::Device> device_;
  test::ExpectNoValidationMessages quiet_;
  Registry registry_;
  render::StageOptions stageOptions_;
  EngineOptions options_;
  std::unique_ptr<Engine> engine_;
};

TEST_F(EngineTest, ShowsWhatRenderMakesAlsoAfterARestart) {
  frames(3);
  EXPECT_EQ(shown().rgba, rendered(options_.graphFile, 3).rgba);
  frames(2);
  engine_->runFrames(3);
  frames(5);  // it pauses after three
  EXPECT_EQ(engine_->frames(), 3u);
  EXPECT_TRUE(engine_->paused());
  EXPECT_EQ(shown().rgba, rendered(options_.graphFile, 3).rgba);
}

TEST_F(EngineTest, AGraphThatDoesNotCompileChangesNothing) {
  frames(1);
  std::string broken = options_.graphJson;
  broken.replace(broken.find("restir_di.Spatial"), 17, "restir_di.Nothing");
  EXPECT_THROW(engine_->setGraph(broken), graph::GraphError);
  EXPECT_THROW(engine_->openGraph("other.json", "{"), graph::GraphError);
  EXPECT_THROW(engine_->openSecond(sourcePath("graphs/none.json")), InputError);
  frames(1);
  EXPECT_EQ(engine_->frames(), 2u);
  EXPECT_EQ(engine_->graph().passes.size(), 6u);
  EXPECT_EQ(engine_->second(), nullptr);
}

TEST_F(EngineTest, AParameterIsTakenOverAndHistoryGoesOn) {
  frames(2);
  std::string edited = options_.graphJson;
  edited.replace(edited.find("\"radius\": 6"), 11, "\"radius\": 9");
  engine_->setGraph(edited);
  frames(1);
  EXPECT_EQ(engine_->frames(), 3u);
  engine_->setSize({32, 16});
  frames(1);
  EXPECT_EQ(shown().width, 32u);
  EXPECT_EQ(shown().height, 16u);
}

TEST_F(EngineTest, KeepsTheShownPortAndForgetsPortsThatAreGone) {
  engine_->keep({"initial.reservoirs"});
  frames(1);
  EXPECT_EQ(engine_->executor().locate("initial.reservoirs").resource->name, "initial.reservoirs");
  // A port of a pass that there is none of is not asked for, so that the graph still compiles.
  engine_->keep({"nobody.port", "initial.nothing"});
  frames(1);
  EXPECT_THROW((void)engine_->executor().locate("nobody.port"), InputError);
}

TEST_F(EngineTest, ASecondGraphHasTheSameFrames) {
  engine_->openSecond(options_.graphFile);
  frames(3);
  ASSERT_NE(engine_->second(), nullptr);
  engine_->second()->finish();
  EXPECT_EQ(engine_->second()->read("radiance").rgba, shown().rgba);
  engine_->openSecond("");
  frames(1);
  EXPECT_EQ(engine_->second(), nullptr);
}

TEST_F(EngineTest, AnotherSceneAndOneThatCannotBe) {
  frames(1);
  render::StageOptions other = stageOptions_;
  other.scene = sourcePath("scenes/materials.glb");
  engine_->setStage(other, stage(other));
  frames(2);
  EXPECT_EQ(engine_->frames(), 2u);
  stageOptions_ = other;
  EXPECT_EQ(shown().rgba, rendered(options_.graphFile, 2).rgba);
}

TEST_F(EngineTest, LightsThatAreEditedAreThoseOfAScenePreparedSo) {
  // Points of its own making, so that there are punctual lights.
  render::StageOptions points = stageOptions_;
  points.lights = 6;
  points.replaceLights = true;
  engine_->setStage(points, stage(points));
  frames(1);
  scene::PunctualLight light = engine_->stage().scene.lights[4];
  light.position += glm::vec3(0.1f, 0.05f, 0.0f);
  light.intensity *= glm::vec3(3.0f, 0.5f, 1.0f);
  engine_->setLight(4, light);
  EXPECT_TRUE(engine_->lightsEdited());
  engine_->runFrames(2);
  frames(2);
  const image::Picture edited = shown();

  auto other = stage(points);
  other->scene.lights[4] = light;
  other->prepared = scene::prepareScene(other->scene);
  for (size_t i = 0; i < other->prepared.lights.size(); ++i) {
    EXPECT_EQ(other->prepared.lights[i].position, engine_->stage().prepared.lights[i].position) << i;
    EXPECT_NEAR(other->prepared.lights[i].pdf, engine_->stage().prepared.lights[i].pdf, 1e-5f) << i;
  }
  Engine fresh(*device_, registry_, options_, points, std::move(other));
  for (int i = 0; i < 2; ++i) fresh.advance(std::nullopt);
  fresh.executor().finish();
  const image::Picture again = fresh.executor().read("radiance");
  double sum = 0.0, difference = 0.0;
  for (size_t i = 0; i < again.rgba.size(); ++i) {
    sum += again.rgba[i];
    difference += std::abs(again.rgba[i] - edited.rgba[i]);
  }
  // The same table but for roundings of its thresholds: nearly every pick is the same.
  EXPECT_LT(difference, 0.02 * sum);

  scene::PunctualLight dark = light;
  dark.intensity = glm::vec3(0.0f);
  EXPECT_THROW(engine_->setLight(4, dark), InputError);
  scene::PunctualLight spot = light;
  spot.kind = scene::LightKind::Spot;
  EXPECT_THROW(engine_->setLight(4, spot), InputError);
  frames(1);
}

TEST_F(EngineTest, CountsRaysWhenAsked) {
  frames(1);
  EXPECT_EQ(engine_->executor().rays(), 0u);
  engine_->countRays(true);
  frames(2);
  EXPECT_GE(engine_->executor().rays(), 24u * 24u);
}

}  // namespace
}  // namespace weir::view
