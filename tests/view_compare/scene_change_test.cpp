// Another scene is loaded while a reference is compared with: nothing of the one before is looked at.
#include <weir/shader/compiler.h>

#include "view/compare/background_reference.h"
#include "view/engine/engine.h"
#include "view_compare/theatre.h"

namespace weir::test {
namespace {

TEST_F(Theatre, TheLastInputDoesNotOutliveItsScene) {
  render::StageOptions moving{.scene = sourcePath("scenes/cornell-moving.glb")};
  moving.animate = true;
  view::EngineOptions options;
  options.graphFile = sourcePath("graphs/all_lights.json");
  options.graphJson = shader::readFile(options.graphFile);
  options.size = {kSide, kSide};
  options.backend = executorOptions_.backend;
  view::Engine engine(*device_, registry_, options, moving,
                      std::make_unique<render::Stage>(render::makeStage(moving, 1.0f)));
  engine.advance(std::nullopt);
  ASSERT_NE(engine.lastInput().state, nullptr);
  const auto reference = [&] {
    return view::BackgroundReference({*device_, compiler_, registry_, engine.sceneGpu(), executorOptions_},
                                     graph("all_lights.json"), engine.lastInput(), kSide, kSide);
  };
  {
    view::BackgroundReference ofMoving = reference();
    advance(ofMoving, 2);
  }
  render::StageOptions still{.scene = sourcePath("scenes/cornell.glb")};
  engine.setStage(still, std::make_unique<render::Stage>(render::makeStage(still, 1.0f)));
  EXPECT_EQ(engine.lastInput().state, nullptr) << "the reference copies what it points to";
  view::BackgroundReference ofStill = reference();
  engine.advance(std::nullopt);
  ofStill.restart(engine.lastInput(), kSide, kSide);
  advance(ofStill, 2);
  EXPECT_EQ(ofStill.frames(), 2u);
}

}  // namespace
}  // namespace weir::test
