// A graph as a node of a test's frames.
#pragma once

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "host.h"
#include "support/pass_test.h"

namespace weir::test {

inline constexpr uint32_t kWidth = 16, kHeight = 12;

/// Uses of images: what a host does before and behind the node.
inline const WeirAccess kNothing{0, 0, VK_IMAGE_LAYOUT_UNDEFINED};
inline const WeirAccess kClear{VK_PIPELINE_STAGE_2_CLEAR_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                               VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL};
inline const WeirAccess kCopyFrom{VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_READ_BIT,
                                  VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL};
inline const WeirAccess kSample{VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT,
                                VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
/// What another node of Weir's does with it.
inline const WeirAccess kStorage{VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                 VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                                 VK_IMAGE_LAYOUT_GENERAL};

/// The mean of what the host brings, times a factor; its g-buffer never runs when the host provides the emission.
inline const char* const kMean = R"({"version": 1, "name": "mean", "passes": {
  "gbuffer": { "type": "gbuffer.RayTraced" },
  "scale": { "type": "template.Scale", "inputs": { "color": "gbuffer.emission" }, "params": { "factor": 2 } },
  "mean": { "type": "output.Accumulate", "inputs": { "color": "scale.color", "history": "mean.state@previous" } } },
  "outputs": { "color": "mean.color" } })";

/// Texts that stay as long as this.
struct Texts {
  std::vector<const char*> all;
  Texts(std::initializer_list<const char*> texts) : all(texts) {}
  operator WeirTexts() const { return {all.data(), static_cast<uint32_t>(all.size())}; }
};

inline WeirScene* makeScene(Host& host, WeirContext* context) {
  const std::string file = sourcePath("scenes/cornell.glb");
  const WeirSceneInfo info{.size = sizeof(WeirSceneInfo), .file = file.c_str(), .width = kWidth, .height = kHeight};
  WeirScene* scene = nullptr;
  if (weirCreateScene(context, &info, &scene) != WEIR_OK) throw std::runtime_error(host.message());
  return scene;
}

class Node {
 public:
  /// `info` without size, width and height.
  Node(Host& host, WeirGraphInfo info, WeirContext* context = nullptr)
      : host_(host), scene_(makeScene(host, context == nullptr ? host.context() : context)) {
    info.size = sizeof info;
    info.width = kWidth;
    info.height = kHeight;
    if (weirCreateGraph(scene_, &info, &graph_) != WEIR_OK) {
      const std::string why = host.message();
      weirDestroyScene(scene_);
      throw std::runtime_error(why);
    }
  }
  ~Node() {
    host_.idle();
    EXPECT_EQ(weirDestroyGraph(graph_), WEIR_OK);
    EXPECT_EQ(weirDestroyScene(scene_), WEIR_OK) << host_.message();
  }
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;
  WeirGraph* graph() { return graph_; }
  WeirScene* scene() { return scene_; }

  WeirStatus bind(const char* name, uint32_t slot, const HostImage& image, const WeirAccess& before,
                  const WeirAccess& after) {
    const WeirImage b{sizeof(WeirImage), name,         slot,        image.image, image.view, image.format,
                      image.width,       image.height, image.usage, before,      after};
    return weirBindImage(graph_, &b);
  }
  WeirStatus bind(const char* name, uint32_t slot, const HostBuffer& buffer) {
    const WeirBuffer b{sizeof(WeirBuffer), name,         slot,
                       buffer.buffer,      buffer.bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                       kStorage,           kStorage};
    return weirBindBuffer(graph_, &b);
  }
  WeirPort port(const char* name) {
    WeirPort p{.size = sizeof(WeirPort)};
    EXPECT_EQ(weirDescribePort(graph_, name, &p), WEIR_OK) << host_.message();
    return p;
  }
  WeirStatus record(VkCommandBuffer commands, uint32_t slot, uint32_t index) {
    const WeirFrame f{
        .size = sizeof(WeirFrame), .slot = slot, .index = index, .queries = queries, .firstQuery = firstQuery};
    return weirRecord(graph_, commands, &f);
  }

  VkQueryPool queries = VK_NULL_HANDLE;
  uint32_t firstQuery = 0;

 private:
  Host& host_;
  WeirScene* scene_;
  WeirGraph* graph_ = nullptr;
};

/// kMean with images of the host's: each frame fills one with a number and looks at the mean.
class MeanNode : public Node {
 public:
  explicit MeanNode(Host& host, WeirContext* context = nullptr)
      : Node(host, {.json = kMean, .provided = Texts{"gbuffer.emission"}, .external = Texts{"mean.color"}}, context),
        host_(host) {
    makeImages(kWidth, kHeight);
  }
  void makeImages(uint32_t width, uint32_t height) {
    for (uint32_t s = 0; s < WEIR_SLOTS; ++s) {
      in_[s] = host_.image(VK_FORMAT_R32G32B32A32_SFLOAT, width, height);
      out_[s] = host_.image(VK_FORMAT_R32G32B32A32_SFLOAT, width, height);
      back_[s] = host_.buffer(VkDeviceSize{16} * width * height);
      EXPECT_EQ(bind("gbuffer.emission", s, in_[s], kClear, kSample), WEIR_OK) << host_.message();
      EXPECT_EQ(bind("mean.color", s, out_[s], kNothing, kCopyFrom), WEIR_OK) << host_.message();
      fresh_[s] = true;
    }
  }
  /// The host's node before, Weir's, the host's node behind.
  void frame(VkCommandBuffer commands, float value) {
    slot = index % WEIR_SLOTS;
    const VkClearColorValue color{{value, value, value, 1.0f}};
    const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    barrier(commands, in_[slot], fresh_[slot] ? kNothing : kSample, kClear);  // as Weir gave it back
    fresh_[slot] = false;
    vkCmdClearColorImage(commands, in_[slot].image, kClear.layout, &color, 1, &all);
    EXPECT_EQ(record(commands, slot, index++), WEIR_OK) << host_.message();
    const VkBufferImageCopy copy{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                 .imageExtent = {out_[slot].width, out_[slot].height, 1}};
    vkCmdCopyImageToBuffer(commands, out_[slot].image, kCopyFrom.layout, back_[slot].buffer, 1, &copy);
  }
  /// What every pixel of the last frame is; the frame must be done.
  float result() {
    const size_t count = size_t{out_[slot].width} * out_[slot].height;
    for (size_t i = 0; i < count; ++i) EXPECT_EQ(back_[slot].mapped[4 * i], back_[slot].mapped[0]) << i;
    return back_[slot].mapped[0];
  }
  float meanWith(float value) {
    host_.run([&](VkCommandBuffer commands) { frame(commands, value); });
    return result();
  }

  uint32_t index = 0, slot = 0;

 private:
  Host& host_;
  HostImage in_[WEIR_SLOTS], out_[WEIR_SLOTS];
  HostBuffer back_[WEIR_SLOTS];
  bool fresh_[WEIR_SLOTS] = {};
};

}  // namespace weir::test
