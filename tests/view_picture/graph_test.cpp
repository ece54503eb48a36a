// Every channel of every port of a running graph, drawn after its frames and looked at in words.
#include <gtest/gtest.h>
#include <weir/core/error.h>
#include <weir/execute/executor.h>
#include <weir/render/stage.h>
#include <weir/trace/acceleration.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "easel.h"
#include "view/picture/words.h"

namespace weir::test {
namespace {

constexpr uint32_t kSide = Easel::kSide;

class PictureGraph : public ::testing::Test {
 protected:
  PictureGraph()
      : registry_({std::filesystem::path(binaryPath("bin"))}),
        stage_(render::makeStage({.scene = sourcePath("scenes/cornell.glb")}, 1.0f)),
        scene_(easel.device(), stage_.scene, stage_.prepared, easel.device().capabilities().accelerationStructure),
        player_(stage_) {}

  execute::Executor& run(const std::vector<std::string>& keep, bool keepAll = false) {
    const graph::CompileOptions options{
        .width = kSide, .height = kSide, .provided = {}, .external = {}, .keep = keep, .keepAll = keepAll};
    executor_ = std::make_unique<execute::Executor>(
        easel.device(), easel.compiler(), registry_, scene_,
        graph::compileFile(sourcePath("graphs/restir_di.json"), {}, registry_.catalog(), options),
        execute::ExecutorOptions{.backend = trace::chooseBackend("auto", easel.device())});
    for (uint32_t f = 0; f < 3; ++f) executor_->frame(player_.frame(f, 1));
    return *executor_;
  }

  view::Port port(const std::string& name) {
    const execute::Executor::Located located = executor_->locate(name);
    return {*located.storage, *located.resource, execute::toGpu(stage_.camera, kSide, kSide)};
  }

  /// A picture with the canvas in its rows, for people: $WEIR_TEST_PICTURES names a folder for them.
  static void leave(const std::string& name, const std::vector<uint8_t>& pixels) {
    const char* folder = std::getenv("WEIR_TEST_PICTURES");
    if (folder == nullptr) return;
    image::Picture picture{.width = kSide, .height = kSide, .rgba = {}, .attributes = {}};
    for (const uint8_t v : pixels) picture.rgba.push_back(static_cast<float>(v) / 255.0f);
    std::filesystem::create_directories(folder);
    image::writePng(std::string(folder) + "/" + name + ".png", picture, image::Encoding::Display);
  }

  Easel easel;
  Registry registry_;
  render::Stage stage_;
  scene::SceneGpu scene_;
  render::Player player_;
  std::unique_ptr<execute::Executor> executor_;
};

TEST_F(PictureGraph, EveryChannelOfEveryPortIsShown) {
  const graph::CompiledGraph& graph = run({}, true).graph();
  size_t ports = 0;
  for (const graph::Resource& resource : graph.resources) {
    if (resource.scratch || resource.depth) continue;
    ++ports;
    const view::Port shown = port(resource.name);
    for (const view::Channel& channel : view::channelsOf(resource, view::meaningOf(graph, resource))) {
      view::PictureMode mode{.low = channel.low, .high = channel.high, .logarithmic = channel.logarithmic};
      if (channel.guessed) {
        easel.values({shown, channel});
        const view::Range range = view::rangeFor(easel.meter().collect(0).value(), channel, mode);
        mode.low = range.low;
        mode.high = range.high;
      }
      easel.draw(shown, channel, mode);
      const std::vector<uint8_t> pixels = easel.pixels();
      leave(resource.name + " " + channel.name, pixels);
      std::set<Rgb> colors;
      for (uint32_t i = 0; i < kSide * kSide; ++i) colors.insert(Easel::at(pixels, i % kSide, i / kSide));
      EXPECT_FALSE(colors.contains(Rgb{255, 0, 255})) << resource.name << " " << channel.name << " isn't finite";
      // Nothing moves, one light shines, every material's metalness and roughness may be the same, alpha is 1: those
      // are plain.
      const bool mayBePlain = resource.name == "gbuffer.motion" || resource.name == "gbuffer.emission" ||
                              channel.name == "A" || channel.name == "sample place" || channel.name == "metallic" ||
                              channel.name == "roughness" || channel.name == "F0" || channel.name == "M" ||
                              channel.name == "state" || channel.name == "hit";
      if (!mayBePlain) {
        EXPECT_GT(colors.size(), 3u) << resource.name << " " << channel.name;
      }
    }
  }
  EXPECT_GE(ports, 9u);
}

TEST_F(PictureGraph, TheTonemappedPictureIsShownAsTheFileHasIt) {
  execute::Executor& executor = run({});
  const view::Port shown = port("tonemap.color");
  const view::Channel rgb = channelNamed(shown.resource, "RGB", view::meaningOf(executor.graph(), shown.resource));
  EXPECT_FALSE(rgb.encoded);
  easel.draw(shown, rgb, {});
  const std::vector<uint8_t> pixels = easel.pixels();
  const image::Picture wanted = executor.read("color");
  for (uint32_t y = 0; y < kSide; ++y)
    for (uint32_t x = 0; x < kSide; ++x) {
      const float* p = wanted.at(x, y);
      expectNear(Easel::at(pixels, x, y), {byteOf(p[0]), byteOf(p[1]), byteOf(p[2])}, "pixel");
    }
}

TEST_F(PictureGraph, WordsOfASurfaceAndItsReservoirAgreeWithTheScene) {
  run({"gbuffer.surface", "spatial.reservoirs"});
  view::Probe probe(easel.device());
  const auto words = [&](const std::string& name) {
    easel.device().submitAndWait([&](VkCommandBuffer commands) {
      probe.record(commands, 1, port(name), {kSide / 2, kSide - 2});
    });
    std::map<std::string, std::string> rows;
    const view::Probed* probed = probe.collect(1);
    if (probed == nullptr) return rows;
    for (const view::Row& row : view::wordsOf(*probed, stage_.prepared.lights)) rows.emplace(row.label, row.text);
    return rows;
  };
  auto surface = words("gbuffer.surface");
  ASSERT_TRUE(surface.contains("shading normal"));
  // The lowest row shows the floor.
  float x = 0, y = 0, z = 0;
  ASSERT_EQ(std::sscanf(surface["shading normal"].c_str(), "(%f, %f, %f)", &x, &y, &z), 3);
  EXPECT_NEAR(y, 1.0f, 1e-3);
  ASSERT_EQ(std::sscanf(surface["position"].c_str(), "(%f, %f, %f)", &x, &y, &z), 3);
  EXPECT_NEAR(y, 0.0f, 1e-3) << surface["position"];
  auto reservoir = words("spatial.reservoirs");
  EXPECT_TRUE(reservoir["sample"].starts_with("light ")) << reservoir["sample"];
}

TEST_F(PictureGraph, PortsThatAreNotKeptAreRefused) {
  execute::Executor& executor = run({});
  EXPECT_THROW(executor.locate("gbuffer.nothing"), InputError);
  size_t refused = 0;
  for (const graph::Resource& resource : executor.graph().resources) {
    if (!resource.transient() || !resource.shares || resource.graphOutput || resource.scratch) continue;
    EXPECT_THROW(executor.locate(resource.name), InputError) << resource.name;
    ++refused;
  }
  EXPECT_GT(refused, 0u);
}

}  // namespace
}  // namespace weir::test
