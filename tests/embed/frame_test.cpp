// Graphs recorded into a host's command buffers: what comes out, and what goes on from one frame to the next.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include "node.h"

namespace weir::test {
namespace {

std::string readFile(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(EmbeddedFrame, ProvidedPortReplacesItsPass) {
  Host host;
  MeanNode node(host);
  EXPECT_EQ(weirDescribePasses(node.graph(), nullptr), WEIR_OK);
  EXPECT_EQ(host.lines(), (std::vector<std::string>{"scale", "mean"}));
  EXPECT_EQ(node.meanWith(1.5f), 3.0f);
  EXPECT_EQ(weirResetHistory(node.graph()), WEIR_OK);
  EXPECT_EQ(node.meanWith(8.0f), 16.0f);
}

TEST(EmbeddedFrame, HistoryOutlivesChangesButNotAResize) {
  Host host;
  MeanNode node(host);
  EXPECT_EQ(node.meanWith(1.0f), 2.0f);
  EXPECT_EQ(node.meanWith(3.0f), 4.0f);  // (2 + 6) / 2
  EXPECT_EQ(weirSet(node.graph(), Texts{"scale.factor=7", "scale.factor=4"}), WEIR_OK) << host.message();
  EXPECT_EQ(node.meanWith(2.5f), 6.0f);                                        // (8 + 10) / 3
  EXPECT_EQ(weirEnable(node.graph(), "scale", 0), WEIR_OK) << host.message();  // another graph
  EXPECT_EQ(node.meanWith(6.0f), 6.0f);                                        // (18 + 6) / 4
  EXPECT_EQ(weirDescribePasses(node.graph(), nullptr), WEIR_OK);
  EXPECT_EQ(host.lines(), (std::vector<std::string>{"mean"}));
  EXPECT_EQ(weirEnable(node.graph(), "scale", 1), WEIR_OK) << host.message();
  EXPECT_EQ(node.meanWith(4.0f), 8.0f);  // (24 + 16) / 5: the factor is still 4

  EXPECT_EQ(weirResize(node.graph(), 8, 4), WEIR_OK) << host.message();
  host.run([&](VkCommandBuffer commands) {
    EXPECT_EQ(node.record(commands, 0, 9), WEIR_BAD_INPUT);
    EXPECT_NE(host.message().find("without the host's resource"), std::string::npos) << host.message();
  });
  node.makeImages(8, 4);
  EXPECT_EQ(node.meanWith(0.5f), 2.0f);
  EXPECT_EQ(node.meanWith(1.0f), 3.0f);
}

TEST(EmbeddedFrame, ARefusedChangeLeavesTheGraphAsItWas) {
  Host host;
  MeanNode node(host);
  EXPECT_EQ(node.meanWith(1.0f), 2.0f);
  EXPECT_EQ(weirSet(node.graph(), Texts{"scale.factr=4"}), WEIR_BAD_INPUT);
  EXPECT_NE(host.message().find("nearest: 'factor'"), std::string::npos) << host.message();
  EXPECT_EQ(weirEnable(node.graph(), "scal", 0), WEIR_BAD_INPUT);
  EXPECT_NE(host.message().find("'scale'"), std::string::npos) << host.message();
  EXPECT_EQ(weirEnable(node.graph(), "mean", 0), WEIR_BAD_INPUT);  // its output is the host's
  EXPECT_EQ(weirResize(node.graph(), 0, 4), WEIR_BAD_INPUT);
  EXPECT_EQ(weirSet(node.graph(), WeirTexts{nullptr, 1}), WEIR_BAD_INPUT);
  EXPECT_EQ(node.meanWith(3.0f), 4.0f);
}

TEST(EmbeddedFrame, ChangesWhileFramesAreInFlight) {
  Host host;
  MeanNode node(host);
  float sum = 0.0f;
  for (int i = 0; i < 6; ++i) {
    // Two frames that nobody waits for, then another graph; the slots are waited for before they come again.
    host.idle();
    for (int k = 0; k < 2; ++k) host.run([&](VkCommandBuffer commands) { node.frame(commands, 1.0f); }, false);
    sum += i % 2 == 0 ? 4.0f : 2.0f;
    EXPECT_EQ(weirEnable(node.graph(), "scale", i % 2), WEIR_OK) << host.message();
  }
  EXPECT_EQ(node.meanWith(1.0f), (sum + 2.0f) / 13.0f);
}

/// What one graph wrote with rays is read by the next one, which knows only compute shaders: synchronization validation
/// sees both, as they are in one command buffer.
TEST(EmbeddedFrame, AGraphMayChangeWithinACommandBuffer) {
  Host host;
  std::string json = readFile(sourcePath("graphs/restir_di.json"));
  const std::string traced = "gbuffer.RayTraced";
  json.replace(json.find(traced), traced.size(), "gbuffer.Raster");
  Node node(host, {.json = json.c_str(),
                   .set = Texts{"initial.visibility=false", "shade.visibility=false", "spatial.visibilityRays=true"},
                   .external = Texts{"tonemap.color"},
                   .trace = "pipeline"});
  for (uint32_t s = 0; s < WEIR_SLOTS; ++s) {
    const HostImage out = host.image(VK_FORMAT_R32G32B32A32_SFLOAT, kWidth, kHeight);
    ASSERT_EQ(node.bind("tonemap.color", s, out, kNothing, kStorage), WEIR_OK) << host.message();
  }
  host.run([&](VkCommandBuffer commands) {
    EXPECT_EQ(node.record(commands, 0, 0), WEIR_OK) << host.message();
    EXPECT_EQ(weirSet(node.graph(), Texts{"spatial.visibilityRays=false"}), WEIR_OK) << host.message();
    EXPECT_EQ(node.record(commands, 1, 1), WEIR_OK) << host.message();
  });
}

TEST(EmbeddedFrame, TwoContextsInOneSubmission) {
  Host host;
  WeirContext* second = nullptr;
  ASSERT_EQ(weirCreateContext(host.weir(), &host.info(), &second), WEIR_OK) << host.message();
  {
    MeanNode first(host), other(host, second);
    host.run([&](VkCommandBuffer commands) {
      first.frame(commands, 1.0f);
      other.frame(commands, 10.0f);
      first.frame(commands, 3.0f);
    });
    EXPECT_EQ(first.result(), 4.0f);
    EXPECT_EQ(other.result(), 20.0f);
  }
  EXPECT_EQ(weirDestroyContext(second), WEIR_OK) << host.message();
}

TEST(EmbeddedFrame, OneNodeFeedsAnother) {
  Host host;
  const Texts provided{"gbuffer.emission"}, external{"mean.color"};
  const WeirGraphInfo info{.json = kMean, .provided = provided, .external = external};
  Node first(host, info), second(host, info);
  const HostImage in = host.image(VK_FORMAT_R32G32B32A32_SFLOAT, kWidth, kHeight),
                  between = host.image(VK_FORMAT_R32G32B32A32_SFLOAT, kWidth, kHeight),
                  out = host.image(VK_FORMAT_R32G32B32A32_SFLOAT, kWidth, kHeight);
  const HostBuffer back = host.buffer(VkDeviceSize{16} * kWidth * kHeight);
  ASSERT_EQ(first.bind("gbuffer.emission", 0, in, kClear, kClear), WEIR_OK) << host.message();
  ASSERT_EQ(first.bind("mean.color", 0, between, kNothing, kStorage), WEIR_OK) << host.message();
  ASSERT_EQ(second.bind("gbuffer.emission", 0, between, kStorage, kStorage), WEIR_OK) << host.message();
  ASSERT_EQ(second.bind("mean.color", 0, out, kNothing, kCopyFrom), WEIR_OK) << host.message();
  host.run([&](VkCommandBuffer commands) {
    const VkClearColorValue color{{1.0f, 1.0f, 1.0f, 1.0f}};
    const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    barrier(commands, in, kNothing, kClear);
    vkCmdClearColorImage(commands, in.image, kClear.layout, &color, 1, &all);
    EXPECT_EQ(first.record(commands, 0, 0), WEIR_OK) << host.message();
    EXPECT_EQ(second.record(commands, 0, 0), WEIR_OK) << host.message();
    const VkBufferImageCopy copy{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                 .imageExtent = {kWidth, kHeight, 1}};
    vkCmdCopyImageToBuffer(commands, out.image, kCopyFrom.layout, back.buffer, 1, &copy);
  });
  EXPECT_EQ(back.mapped[0], 4.0f);
}

TEST(EmbeddedFrame, RecordingTouchesNoQueue) {
  Host host;
  MeanNode node(host);
  EXPECT_GT(watched().submits, 0);  // loading the scene did, so the watch works
  const int submits = watched().submits, waits = watched().waits;
  host.run([&](VkCommandBuffer commands) { node.frame(commands, 1.0f); });
  node.meanWith(1.0f);
  EXPECT_EQ(watched().submits, submits);
  EXPECT_EQ(watched().waits, waits);
}

TEST(EmbeddedFrame, TimesOfPasses) {
  Host host;
  MeanNode node(host);
  uint32_t needed = 0;
  ASSERT_EQ(weirDescribePasses(node.graph(), &needed), WEIR_OK);
  ASSERT_EQ(needed, 4u);
  constexpr uint32_t kFirst = 3;  // the host's own come before
  const VkQueryPool queries = host.queries(kFirst + needed);
  vkResetQueryPool(host.info().device, queries, 0, kFirst + needed);
  double times[2] = {-1.0, -1.0};
  EXPECT_EQ(weirReadTimes(node.graph(), queries, kFirst, times, 2), WEIR_BAD_INPUT)
      << "no frame was recorded with them";
  node.queries = queries;
  node.firstQuery = kFirst;
  for (int i = 0; i < 2; ++i)  // also where an older frame's are still in there
    host.run([&](VkCommandBuffer commands) {
      node.frame(commands, 1.0f);
      EXPECT_EQ(weirReadTimes(node.graph(), queries, kFirst, times, 2), WEIR_NOT_READY);
    });
  EXPECT_EQ(weirReadTimes(node.graph(), queries, kFirst, times, 2), WEIR_OK) << host.message();
  for (double t : times) EXPECT_TRUE(t >= 0.0 && t < 1e4) << t;
  EXPECT_EQ(weirReadTimes(node.graph(), queries, kFirst, times, 3), WEIR_BAD_INPUT);
  EXPECT_EQ(weirReadTimes(node.graph(), VK_NULL_HANDLE, kFirst, times, 2), WEIR_BAD_INPUT);
}

/// The whole graph, and the same cut in two at the g-buffer, whose buffers and images the host owns.
TEST(EmbeddedFrame, GraphCutInTwoGivesTheSamePicture) {
  Host host;
  const std::string file = sourcePath("graphs/restir_di.json");
  Node whole(host, {.file = file.c_str(), .external = Texts{"tonemap.color"}});
  Node front(host, {.json = R"({"version": 1, "name": "front", "passes": { "gbuffer": { "type": "gbuffer.RayTraced" } },
                              "outputs": { "surface": "gbuffer.surface", "emission": "gbuffer.emission" } })",
                    .external = Texts{"gbuffer.surface", "gbuffer.emission", "gbuffer.motion"}});
  Node rest(host,
            {.file = file.c_str(),
             .provided = Texts{"gbuffer.surface", "gbuffer.surface@previous", "gbuffer.emission", "gbuffer.motion"},
             .external = Texts{"tonemap.color"}});
  EXPECT_EQ(weirDescribePasses(rest.graph(), nullptr), WEIR_OK);
  EXPECT_EQ(host.lines(), (std::vector<std::string>{"initial", "temporal", "spatial", "shade", "tonemap"}));
  const WeirPort surface = front.port("gbuffer.surface");
  EXPECT_EQ(surface.format, VK_FORMAT_UNDEFINED);
  EXPECT_EQ(surface.bytes, uint64_t{24} * kWidth * kHeight);
  EXPECT_EQ(surface.written, 1u);
  EXPECT_EQ(rest.port("gbuffer.surface").written, 0u);

  HostBuffer surfaces[WEIR_SLOTS], back[2];
  HostImage pictures[2];
  for (HostBuffer& s : surfaces) {
    s = host.buffer(surface.bytes);
    std::fill_n(s.mapped, surface.bytes / 4, 0.0f);  // nothing was there before the first frame
  }
  for (HostBuffer& b : back) b = host.buffer(VkDeviceSize{16} * kWidth * kHeight);
  for (HostImage& p : pictures) p = host.image(VK_FORMAT_R32G32B32A32_SFLOAT, kWidth, kHeight);
  const HostImage emission = host.image(VK_FORMAT_R32G32B32A32_SFLOAT, kWidth, kHeight),
                  motion = host.image(VK_FORMAT_R32G32_SFLOAT, kWidth, kHeight);
  for (uint32_t s = 0; s < WEIR_SLOTS; ++s) {
    ASSERT_EQ(front.bind("gbuffer.surface", s, surfaces[s]), WEIR_OK) << host.message();
    ASSERT_EQ(rest.bind("gbuffer.surface", s, surfaces[s]), WEIR_OK) << host.message();
    ASSERT_EQ(rest.bind("gbuffer.surface@previous", s, surfaces[1 - s]), WEIR_OK) << host.message();
    WeirAccess discarded = kStorage;
    discarded.layout = VK_IMAGE_LAYOUT_UNDEFINED;
    ASSERT_EQ(front.bind("gbuffer.emission", s, emission, discarded, kStorage), WEIR_OK) << host.message();
    ASSERT_EQ(front.bind("gbuffer.motion", s, motion, discarded, kStorage), WEIR_OK) << host.message();
    ASSERT_EQ(rest.bind("gbuffer.emission", s, emission, kStorage, kStorage), WEIR_OK) << host.message();
    ASSERT_EQ(rest.bind("gbuffer.motion", s, motion, kStorage, kStorage), WEIR_OK) << host.message();
    WeirAccess copied = kCopyFrom;
    copied.access = 0;
    copied.layout = VK_IMAGE_LAYOUT_UNDEFINED;
    ASSERT_EQ(whole.bind("tonemap.color", s, pictures[0], copied, kCopyFrom), WEIR_OK) << host.message();
    ASSERT_EQ(rest.bind("tonemap.color", s, pictures[1], copied, kCopyFrom), WEIR_OK) << host.message();
  }
  for (uint32_t i = 0; i < 3; ++i) {
    host.run([&](VkCommandBuffer commands) {
      for (Node* node : {&whole, &front, &rest})
        EXPECT_EQ(node->record(commands, i % WEIR_SLOTS, i), WEIR_OK) << host.message();
      const VkBufferImageCopy copy{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                   .imageExtent = {kWidth, kHeight, 1}};
      for (int k = 0; k < 2; ++k)
        vkCmdCopyImageToBuffer(commands, pictures[k].image, kCopyFrom.layout, back[k].buffer, 1, &copy);
    });
    float brightest = 0.0f;
    for (size_t c = 0; c < size_t{4} * kWidth * kHeight; ++c) {
      EXPECT_EQ(back[0].mapped[c], back[1].mapped[c]) << "frame " << i << ", value " << c;
      if (c % 4 != 3) brightest = std::max(brightest, back[0].mapped[c]);
    }
    EXPECT_GT(brightest, 0.1f);
  }
}

TEST(EmbeddedFrame, CameraMovesThePicture) {
  Host host;
  const std::string file = sourcePath("graphs/template.json");
  Node node(host, {.file = file.c_str(), .external = Texts{"scale.color"}});
  const HostImage picture = host.image(VK_FORMAT_R32G32B32A32_SFLOAT, kWidth, kHeight);
  const HostBuffer back = host.buffer(VkDeviceSize{16} * kWidth * kHeight);
  ASSERT_EQ(node.bind("scale.color", 0, picture, kNothing, kCopyFrom), WEIR_OK) << host.message();
  const auto sumWith = [&](const WeirCamera& camera) {
    host.run([&](VkCommandBuffer commands) {
      const WeirFrame f{.size = sizeof(WeirFrame), .camera = &camera};
      EXPECT_EQ(weirRecord(node.graph(), commands, &f), WEIR_OK) << host.message();
      const VkBufferImageCopy copy{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                   .imageExtent = {kWidth, kHeight, 1}};
      vkCmdCopyImageToBuffer(commands, picture.image, kCopyFrom.layout, back.buffer, 1, &copy);
    });
    double sum = 0.0;
    for (size_t c = 0; c < size_t{4} * kWidth * kHeight; ++c) sum += c % 4 == 3 ? 0.0 : back.mapped[c];
    return sum;
  };
  // From far outside the box: into it, and away from it.
  EXPECT_GT(sumWith({{0, 1, 20}, {0, 0, -3}, {0, 1, 0.5f}, 0.5f}), 0.0);
  EXPECT_EQ(sumWith({{0, 1, 20}, {0, 0, 1}, {0, 1, 0}, 0.5f}), 0.0);
  for (const WeirCamera& wrong :
       {WeirCamera{{NAN, 0, 0}, {0, 0, -1}, {0, 1, 0}, 1}, WeirCamera{{0, 0, 0}, {0, 0, 0}, {0, 1, 0}, 1},
        WeirCamera{{0, 0, 0}, {0, 2, 0}, {0, 1, 0}, 1}, WeirCamera{{0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 4}}) {
    host.run([&](VkCommandBuffer commands) {
      const WeirFrame f{.size = sizeof(WeirFrame), .camera = &wrong};
      EXPECT_EQ(weirRecord(node.graph(), commands, &f), WEIR_BAD_INPUT);
      EXPECT_NE(host.message().find("WeirCamera."), std::string::npos) << host.message();
    });
  }
}

}  // namespace
}  // namespace weir::test
