#include <gtest/gtest.h>
#include <weir/scene/import.h>

#include "support/pass_test.h"

namespace weir::test {
namespace {

TEST(GBuffer, TracesTheCornellBox) {
  scene::Scene scene = scene::importGltf(sourcePath("scenes/cornell.glb"));
  const scene::Camera camera = scene::chooseCamera(scene, "", 1.0f);
  PassTest t("gbuffer.RayTraced");
  t.size(32, 32).scene(std::move(scene)).camera(camera);
  t.run();
  const std::vector<float> motion = t.output<float>("motion");
  EXPECT_EQ(motion.size(), 2u * 32 * 32);
}

}  // namespace
}  // namespace weir::test
