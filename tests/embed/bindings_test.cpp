// What a host binds is checked, and what does not fit is said in words.
#include <gtest/gtest.h>

#include <functional>

#include "node.h"

namespace weir::test {
namespace {

class Bindings : public testing::Test {
 protected:
  void expect(WeirStatus status, const std::string& words) {
    EXPECT_EQ(status, WEIR_BAD_INPUT);
    EXPECT_NE(host.message().find(words), std::string::npos) << "should say " << words << ":\n" << host.message();
  }
  WeirStatus bindWith(const std::function<void(WeirImage&)>& change) {
    WeirImage b{sizeof(WeirImage), "gbuffer.emission", 0,           image.image, image.view, image.format,
                image.width,       image.height,       image.usage, kClear,      kSample};
    change(b);
    return weirBindImage(node.graph(), &b);
  }

  Host host;
  Node node{host, {.json = kMean, .provided = Texts{"gbuffer.emission"}, .external = Texts{"mean.color"}}};
  HostImage image = host.image(VK_FORMAT_R32G32B32A32_SFLOAT, kWidth, kHeight);
};

TEST_F(Bindings, DescribesEveryPort) {
  WeirPort port{.size = sizeof(WeirPort)};
  EXPECT_EQ(weirDescribePort(node.graph(), "mean.color", &port), WEIR_OK) << host.message();
  EXPECT_EQ(host.lines(), (std::vector<std::string>{"mean.color", "gbuffer.emission"}));
  EXPECT_EQ(port.format, VK_FORMAT_R32G32B32A32_SFLOAT);
  EXPECT_EQ(port.width, kWidth);
  EXPECT_EQ(port.height, kHeight);
  EXPECT_EQ(port.written, 1u);
  expect(weirDescribePort(node.graph(), "mean.colour", &port), "nearest: 'mean.color'");
}

TEST_F(Bindings, ImagesThatDoNotFitAreRefused) {
  EXPECT_EQ(bindWith([](WeirImage&) {}), WEIR_OK) << host.message();
  expect(bindWith([](WeirImage& b) { b.name = "gbufer.emission"; }), "nearest: 'gbuffer.emission'");
  expect(bindWith([](WeirImage& b) { b.name = "gbuffer.motion"; }), "gbuffer.motion");
  expect(bindWith([](WeirImage& b) { b.format = VK_FORMAT_R8G8B8A8_UNORM; }), "RGBA8 (VkFormat 37); expected RGBA32F");
  expect(bindWith([](WeirImage& b) { b.width = 15; }), "15x12; expected 16x12");
  expect(bindWith([](WeirImage& b) { b.slot = 2; }), "slot 2; expected 0 to 1");
  expect(bindWith([](WeirImage& b) { b.usage = VK_IMAGE_USAGE_SAMPLED_BIT; }), "VK_IMAGE_USAGE_STORAGE_BIT");
  expect(bindWith([](WeirImage& b) { b.view = VK_NULL_HANDLE; }), "view");
  expect(bindWith([](WeirImage& b) { b.before.layout = VK_IMAGE_LAYOUT_UNDEFINED; }), "throw its content away");
  expect(bindWith([](WeirImage& b) { b.after.layout = VK_IMAGE_LAYOUT_UNDEFINED; }), "after.layout");
  expect(bindWith([](WeirImage& b) { b.name = nullptr; }), "WeirImage.name");
  expect(bindWith([](WeirImage& b) { b.size = 8; }), "WeirImage.size is 8");
  expect(node.bind("mean.color", 0, host.buffer(64)), "weirBindImage");
}

TEST_F(Bindings, BuffersThatDoNotFitAreRefused) {
  const std::string file = sourcePath("graphs/restir_di.json");
  Node surfaces(host, {.file = file.c_str(),
                       .provided = Texts{"gbuffer.surface", "gbuffer.surface@previous"},
                       .external = Texts{"shade.color"}});
  const HostBuffer small = host.buffer(64), enough = host.buffer(VkDeviceSize{24} * kWidth * kHeight);
  expect(surfaces.bind("gbuffer.surface", 0, small), "64 bytes; expected at least 4608");
  EXPECT_EQ(surfaces.bind("gbuffer.surface@previous", 0, enough), WEIR_OK) << host.message();
  expect(surfaces.bind("gbuffer.surface@previus", 0, enough), "nearest: 'gbuffer.surface@previous'");
  expect(surfaces.bind("gbuffer.surface", 0, image, kClear, kSample), "weirBindBuffer");
}

TEST_F(Bindings, OneImageThatIsOnlyReadMayStandForTwoPorts) {
  Node two(host, {.json = R"({"version": 1, "name": "two", "passes": {
                    "g": {"type": "gbuffer.RayTraced"}, "h": {"type": "gbuffer.RayTraced"},
                    "a": {"type": "template.Scale", "inputs": {"color": "g.emission"}},
                    "b": {"type": "template.Scale", "inputs": {"color": "h.emission"}}},
                    "outputs": {"a": "a.color", "b": "b.color"}})",
                  .provided = Texts{"g.emission", "h.emission"}});
  EXPECT_EQ(two.bind("g.emission", 0, image, kClear, kSample), WEIR_OK) << host.message();
  expect(two.bind("h.emission", 0, image, kClear, kClear), "the same image");
  EXPECT_EQ(two.bind("h.emission", 0, image, kClear, kSample), WEIR_OK) << host.message();
  host.run([&](VkCommandBuffer commands) {
    barrier(commands, image, kNothing, kClear);
    EXPECT_EQ(two.record(commands, 0, 0), WEIR_OK) << host.message();  // one way into the layout, and one out of it
  });
  ASSERT_EQ(bindWith([](WeirImage&) {}), WEIR_OK) << host.message();
  expect(node.bind("mean.color", 0, image, kClear, kSample), "the same image");
}

TEST_F(Bindings, AGraphInWhichNothingRunsStillHandsOver) {
  Node idle(host, {.json = R"({"version": 1, "name": "idle", "passes": {"g": {"type": "gbuffer.RayTraced"}},
                     "outputs": {"o": "g.emission"}})",
                   .provided = Texts{"g.emission"}});
  EXPECT_EQ(idle.bind("g.emission", 0, image, kClear, kSample), WEIR_OK) << host.message();
  host.run([&](VkCommandBuffer commands) {
    barrier(commands, image, kNothing, kClear);
    EXPECT_EQ(idle.record(commands, 0, 0), WEIR_OK) << host.message();
    barrier(commands, image, kSample, kClear);
  });
}

TEST_F(Bindings, RecordingNamesWhatIsNotBound) {
  ASSERT_EQ(bindWith([](WeirImage&) {}), WEIR_OK) << host.message();
  host.run([&](VkCommandBuffer commands) {
    expect(node.record(commands, 0, 0), "'mean.color' for slot 0");
    expect(node.record(commands, 1, 0), "slot 1");
    expect(node.record(commands, 2, 0), "slot 2; expected 0 to 1");
  });
}

TEST_F(Bindings, GraphsThatAreWrongAreExplained) {
  const auto make = [&](WeirGraphInfo info) {
    info.size = sizeof info;
    info.width = kWidth;
    info.height = kHeight;
    WeirGraph* graph = nullptr;
    return weirCreateGraph(node.scene(), &info, &graph);
  };
  expect(make({}), "a file or a JSON text");
  expect(make({.json = "{"}), "WeirGraphInfo.json:1");
  expect(make({.file = "no/such/graph.json"}), "no/such/graph.json");
  expect(make({.json = kMean, .provided = Texts{"gbuffer.emision"}}), "nearest: 'gbuffer.emission'");
  expect(make({.json = kMean, .external = Texts{"mean.colr"}}), "nearest: 'mean.color'");
  expect(make({.json = kMean, .set = Texts{"scale.factor=9999"}}), "1000");
  expect(make({.json = kMean, .trace = "rays"}), "auto, pipeline, query");
  // The host may not take what the graph keeps as history.
  expect(make({.json = kMean, .external = Texts{"mean.state"}}), "@previous");
}

}  // namespace
}  // namespace weir::test
