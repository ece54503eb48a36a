// A camera moved by hand is one that `--camera` can say, to the last bit.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "view/engine/camera_control.h"

namespace weir::view {
namespace {

scene::Bounds bounds() {
  scene::Bounds b;
  b.add({-10.0f, 0.0f, -5.0f});
  b.add({10.0f, 6.0f, 5.0f});
  return b;
}

CameraControl control() {
  return {scene::chooseCamera(scene::Scene{}, "-9,1.5,0.3,9,3,0,75", 1.0f), "-9,1.5,0.3,9,3,0,75", bounds()};
}

bool same(const scene::Camera& a, const scene::Camera& b) {
  return a.eye == b.eye && a.forward == b.forward && a.up == b.up && a.verticalFov == b.verticalFov;
}

TEST(CameraControl, WordsGiveTheVerySameCameraAfterAnyMotion) {
  CameraControl camera = control();
  std::mt19937 random(7);
  std::uniform_real_distribution<float> any(-1.0f, 1.0f);
  for (int i = 0; i < 2000; ++i) {
    switch (random() % 6) {
      case 0:
        camera.orbit({any(random), any(random)});
        break;
      case 1:
        camera.look({any(random), any(random)});
        break;
      case 2:
        camera.pan({any(random), any(random)});
        break;
      case 3:
        camera.approach(3.0f * any(random));
        break;
      case 4:
        camera.fly({any(random), any(random), any(random)}, 0.1f);
        break;
      default:
        camera.setFieldOfView(60.0f + 50.0f * any(random));
        break;
    }
    ASSERT_TRUE(same(scene::chooseCamera(scene::Scene{}, camera.text(), 1.0f), camera.camera())) << camera.text();
    ASSERT_NEAR(glm::length(camera.camera().forward), 1.0f, 1e-5f);
    ASSERT_NEAR(glm::dot(camera.camera().forward, camera.camera().up), 0.0f, 1e-5f);
  }
  EXPECT_FALSE(camera.untouched());
}

TEST(CameraControl, OrbitKeepsTargetAndDistanceAndLookKeepsTheEye) {
  CameraControl camera = control();
  const glm::vec3 target = camera.target(), eye = camera.camera().eye;
  const float distance = glm::distance(eye, target);
  camera.orbit({0.5f, 0.2f});
  EXPECT_LT(glm::distance(camera.target(), target), 1e-4f);
  EXPECT_NEAR(glm::distance(camera.camera().eye, target), distance, 1e-3f);
  const glm::vec3 there = camera.camera().eye;
  camera.look({0.3f, -0.1f});
  EXPECT_EQ(camera.camera().eye, there);
}

TEST(CameraControl, NeverTurnsOverTheTop) {
  CameraControl camera = control();
  for (int i = 0; i < 50; ++i) camera.look({0.0f, 0.3f});
  EXPECT_GT(camera.camera().up.y, 0.0f);
  EXPECT_LT(camera.camera().forward.y, 1.0f);
}

TEST(CameraControl, UntouchedItSaysWhatItWasSetWith) {
  scene::Camera exact;
  exact.forward = glm::normalize(glm::vec3(0.1f, 0.2f, -1.0f));
  CameraControl camera(exact, "", bounds());
  EXPECT_TRUE(camera.untouched());
  EXPECT_TRUE(same(camera.camera(), exact));
  EXPECT_EQ(camera.text(), "");
  camera.set(exact, "front");
  EXPECT_EQ(camera.text(), "front");
}

TEST(CameraControl, FramesAllOfASceneAndOfNone) {
  CameraControl camera = control();
  camera.frame(16.0f / 9.0f);
  EXPECT_LT(glm::distance(camera.target(), bounds().centre()), 1e-4f);
  CameraControl nothing(scene::Camera{}, "", scene::Bounds{});
  nothing.frame(1.0f);
  nothing.orbit({0.1f, 0.1f});
  nothing.approach(100.0f);
  EXPECT_TRUE(std::isfinite(nothing.camera().eye.x) && std::isfinite(nothing.camera().forward.x));
}

}  // namespace
}  // namespace weir::view
