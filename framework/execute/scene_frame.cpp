#include <weir/execute/scene_frame.h>

#include <cmath>
#include <cstring>

namespace weir::execute {
namespace {

constexpr uint32_t kConstantsStride = 256;  // the largest minUniformBufferOffsetAlignment that Vulkan allows
static_assert(sizeof(FrameConstants) <= kConstantsStride);

}  // namespace

GpuCamera toGpu(const scene::Camera& camera, uint32_t width, uint32_t height) {
  const float t = std::tan(camera.verticalFov * 0.5f);
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  const glm::vec3 right = glm::normalize(glm::cross(camera.forward, camera.up));
  const glm::vec3 up = glm::cross(right, camera.forward);
  return {glm::vec4(camera.eye, 0), glm::vec4(camera.forward, 0), glm::vec4(right * t * aspect, 0),
          glm::vec4(up * t, 0)};
}

uint32_t SceneFrame::constantsOffset(uint32_t slot) {
  return slot * kConstantsStride;
}

SceneFrame::SceneFrame(const gpu::Device& device, shader::Compiler& compiler, const scene::SceneGpu& scene)
    : scene_(scene) {
  constants_ = gpu::Buffer(device, uint64_t{kSlots} * kConstantsStride, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT,
                           gpu::Residency::Upload, "frame constants");
  rayCounter_ = gpu::Buffer(device, sizeof(uint32_t), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Residency::Readback,
                            "ray counter");
  if (!scene.traits.animated) {
    sets_[0] = sets_[1] = scene.makeSet(constants_, sizeof(FrameConstants), rayCounter_);
    return;
  }
  motion_ = std::make_unique<SceneMotion>(device, compiler, scene);
  for (uint32_t parity = 0; parity < 2; ++parity) {
    const scene::MovingBindings moving = motion_->bindings(parity);
    sets_[parity] = scene.makeSet(constants_, sizeof(FrameConstants), rayCounter_, &moving);
  }
}

SceneFrame::~SceneFrame() {
  if (sets_[1] != sets_[0]) scene_.freeSet(sets_[1]);
  scene_.freeSet(sets_[0]);
}

void SceneFrame::begin(VkCommandBuffer commands, const FrameInput& input, uint32_t slot, uint32_t width,
                       uint32_t height) {
  if (input.cut) fresh_ = true;
  if (motion_) motion_->record(commands, slot, parity(), input.state, fresh_);
  writeConstants(input, slot, width, height);
}

void SceneFrame::end() {
  previousCamera_ = camera_;
  fresh_ = false;
  ++frames_;
}

void SceneFrame::writeConstants(const FrameInput& input, uint32_t slot, uint32_t width, uint32_t height) {
  FrameConstants c;
  c.camera = toGpu(input.camera, width, height);
  c.previousCamera = fresh_ ? c.camera : previousCamera_;
  camera_ = c.camera;
  c.width = width;
  c.height = height;
  c.frame = input.index;
  c.seed = input.seed;
  c.lights = scene_.lightCount;
  c.instances = scene_.instanceCount;
  c.sceneDiameter = motion_ ? motion_->diameter() : scene_.diameter;
  c.sceneLargest = motion_ ? motion_->largestSide() : scene_.largestSide;
  // Depth is near/z in 32-bit floats, so that a near plane this close costs no precision.
  c.sceneNear = c.sceneDiameter * 0x1p-20f;
  std::memcpy(constants_.mapped() + constantsOffset(slot), &c, sizeof c);
  constants_.flush();
}

}  // namespace weir::execute
