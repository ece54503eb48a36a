#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/execute/scene_frame.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace weir::execute {

static_assert(sizeof(FrameConstants) <= SceneFrame::kLaneStride);

GpuCamera toGpu(const scene::Camera& camera, uint32_t width, uint32_t height) {
  const float t = std::tan(camera.verticalFov * 0.5f);
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  const glm::vec3 right = glm::normalize(glm::cross(camera.forward, camera.up));
  const glm::vec3 up = glm::cross(right, camera.forward);
  return {glm::vec4(camera.eye, 0), glm::vec4(camera.forward, 0), glm::vec4(right * t * aspect, 0),
          glm::vec4(up * t, 0)};
}

SceneFrame::SceneFrame(const gpu::Device& device, shader::Compiler& compiler, const scene::SceneGpu& scene,
                       uint32_t lanes)
    : scene_(scene), lanes_(lanes), active_(lanes), activeBefore_(lanes) {
  if (lanes == 0 || lanes > kMostLanes) throw InputError(fmt::format("{} lanes: must be 1 … {}", lanes, kMostLanes));
  constants_ = gpu::Buffer(device, uint64_t{kSlots} * lanes * kLaneStride, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT,
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
  activate(input);
  if (motion_) motion_->record(commands, slot, parity(), input.state, fresh_);
  writeConstants(input, slot, width, height);
}

void SceneFrame::activate(const FrameInput& input) {
  const size_t wanted = std::max<size_t>(input.laneSeeds.size(), 1);
  if (wanted > lanes_) throw InputError(fmt::format("a frame of {} lanes: there are {}", wanted, lanes_));
  // What a lane that was left out has of the past is not the last frame's.
  if (wanted > activeBefore_ && !fresh_)
    throw InputError(
        fmt::format("a frame of {} lanes after one of {}: only a cut brings lanes back", wanted, activeBefore_));
  active_ = static_cast<uint32_t>(wanted);
}

void SceneFrame::end() {
  previousCamera_ = camera_;
  activeBefore_ = active_;
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
  c.lights = scene_.lightCount;
  c.instances = scene_.instanceCount;
  c.sceneDiameter = motion_ ? motion_->diameter() : scene_.diameter;
  c.sceneLargest = motion_ ? motion_->largestSide() : scene_.largestSide;
  // Depth is near/z in 32-bit floats, so that a near plane this close costs no precision.
  c.sceneNear = c.sceneDiameter * 0x1p-20f;
  for (uint32_t lane = 0; lane < active_; ++lane) {
    c.seed = input.laneSeeds.empty() ? input.seed : input.laneSeeds[lane];
    std::memcpy(constants_.mapped() + constantsOffset(slot) + uint64_t{lane} * kLaneStride, &c, sizeof c);
  }
  constants_.flush();
}

}  // namespace weir::execute
