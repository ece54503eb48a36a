// Passes that only trace rays or move bytes: that they trace the rays that they say, and move those bytes.
#include <gtest/gtest.h>
#include <weir/execute/executor.h>
#include <weir/graph/compile.h>
#include <weir/pass/registry.h>
#include <weir/trace/acceleration.h>

#include <cstring>
#include <filesystem>

#include "support/device.h"
#include "support/small_scenes.h"

namespace weir::test {
namespace {

constexpr uint32_t kSide = 48;

/// A floor, a block above it and a lamp over both; the upper part of the picture shows nothing.
scene::Scene blockOverFloor() {
  Builder b;
  scene::Material grey, lamp;
  grey.baseColor = {0.6f, 0.6f, 0.6f, 1.0f};
  grey.metallic = 0.0f;
  lamp.emission = {20, 20, 20};
  const int greyOne = b.material(grey);
  b.add(quad({-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}, greyOne));
  b.add(quad({-0.6f, 0.5f, 0.6f}, {0.6f, 0.5f, 0.6f}, {0.6f, 0.5f, -0.6f}, {-0.6f, 0.5f, -0.6f}, greyOne));
  b.add(quad({-0.3f, 2, -0.3f}, {0.3f, 2, -0.3f}, {0.3f, 2, 0.3f}, {-0.3f, 2, 0.3f}, b.material(lamp)));
  b.scene.cameras.push_back(lookAt({0.2f, 1.2f, 3.5f}, {0, 0.4f, 0}, 60));
  return b.scene;
}

class Floor : public testing::Test {
 protected:
  /// One frame of a G-buffer, candidates and the floor's passes.
  void run(const std::string& initial) {
    const std::string json = R"({"version": 1, "passes": {"gbuffer": {"type": "gbuffer.RayTraced"},
      "initial": {"type": "restir_di.Initial", "inputs": {"surface": "gbuffer.surface"}, "params": {"candidates": 4)" +
                             initial + R"(}}, "camera": {"type": "floor.CameraRays"},
      "shadow": {"type": "floor.ShadowRays", "inputs": {"surface": "gbuffer.surface", "reservoirs": "initial.reservoirs"}},
      "buffers": {"type": "floor.Buffers", "params": {"words": 5}}},
      "outputs": {"c": "camera.triangle", "s": "shadow.transmittance", "b": "buffers.words", "r": "initial.reservoirs"}})";
    graph::CompileOptions options;
    options.width = options.height = kSide;
    options.keepAll = true;
    execute::ExecutorOptions executing;
    executing.backend = trace::chooseBackend("auto", *device_);
    executing.countRays = true;
    executor_ = std::make_unique<execute::Executor>(*device_, compiler_, registry_, gpu_,
                                                    graph::compileText(json, "floor", {}, registry_.catalog(), options),
                                                    executing);
    executor_->frame({scene_.cameras.front(), 0, 3, false});
  }
  template <typename T>
  std::vector<T> read(const std::string& name) {
    const std::vector<std::byte> bytes = executor_->readResource(name);
    std::vector<T> values(bytes.size() / sizeof(T));
    std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
    return values;
  }

  std::shared_ptr<gpu::Device> device_ = validatedDevice();
  ExpectNoValidationMessages guard_{*device_};
  Registry registry_{{std::filesystem::path(binaryPath("bin"))}};
  scene::Scene scene_ = blockOverFloor();
  scene::PreparedScene prepared_ = scene::prepareScene(scene_);
  scene::SceneGpu gpu_{*device_, scene_, prepared_, device_->capabilities().accelerationStructure};
  shader::Compiler compiler_;
  std::unique_ptr<execute::Executor> executor_;
};

// Where the G-buffer has a surface the camera's ray met a triangle, and nowhere else.
TEST_F(Floor, CameraRaysMeetWhatTheGBufferShows) {
  run("");
  const std::vector<uint32_t> triangles = read<uint32_t>("camera.triangle");
  const std::vector<uint32_t> surfaces = read<uint32_t>("gbuffer.surface");
  ASSERT_EQ(triangles.size(), size_t{kSide} * kSide);
  size_t met = 0;
  for (size_t i = 0; i < triangles.size(); ++i) {
    const bool surface = surfaces[6 * i] != 0;  // its distance
    ASSERT_EQ(triangles[i] != 0xffffffffu, surface) << i;
    if (surface) {
      ASSERT_LT(triangles[i], prepared_.triangles.size());
    }
    met += surface ? 1 : 0;
  }
  EXPECT_GT(met, 500u);
  EXPECT_LT(met, triangles.size() - 300);
}

// Samples that passed Initial's own ray are seen; without that ray some are hidden, which light comes through nowhere.
TEST_F(Floor, ShadowRaysTestTheReservoirs) {
  size_t hidden = 0;
  for (const bool visibility : {true, false}) {
    run(visibility ? R"(, "visibility": true)" : R"(, "visibility": false)");
    const std::vector<float> through = read<float>("shadow.transmittance");
    const std::vector<float> reservoirs = read<float>("initial.reservoirs");
    size_t asked = 0;
    for (size_t i = 0; i < through.size(); ++i) {
      const bool sample = reservoirs[4 * i + 2] > 0.0f;
      asked += sample ? 1 : 0;
      if (!sample) {
        ASSERT_EQ(through[i], -1.0f) << i;
      } else if (visibility) {
        ASSERT_EQ(through[i], 1.0f) << i;
      } else {
        ASSERT_TRUE(through[i] == 0.0f || through[i] == 1.0f) << i;
        hidden += through[i] == 0.0f ? 1 : 0;
      }
    }
    EXPECT_GT(asked, 400u);
    // G-buffer, the floor's camera rays, Initial's own and the floor's shadow rays: no more and no fewer.
    executor_->finish();
    if (!visibility) {
      EXPECT_EQ(executor_->rays(), 2 * through.size() + asked);
    }
  }
  EXPECT_GT(hidden, 30u);
}

TEST_F(Floor, BuffersHaveSoManyWordsAPixel) {
  run("");
  EXPECT_EQ(read<uint32_t>("buffers.words").size(), size_t{5} * kSide * kSide);
}

}  // namespace
}  // namespace weir::test
