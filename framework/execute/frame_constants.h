// What every kernel may read of the frame: one std140 block, a slot for each frame in flight.
#pragma once

#include <weir/scene/scene.h>

#include <cstdint>
#include <glm/glm.hpp>

namespace weir::execute {

/// A pinhole camera as shaders read it: right and up are scaled so that direction = forward + ndc.x · right - ndc.y ·
/// up.
struct GpuCamera {
  glm::vec4 origin{0.0f}, forward{0.0f}, right{0.0f}, up{0.0f};
};

struct FrameConstants {
  GpuCamera camera, previousCamera;
  uint32_t width = 0, height = 0, frame = 0, seed = 0;
  uint32_t lights = 0, instances = 0;
  float sceneDiameter = 0.0f, sceneNear = 0.0f;
  float sceneLargest = 0.0f, pad[3] = {0.0f, 0.0f, 0.0f};  ///< longest side of any triangle, metres
};
static_assert(sizeof(FrameConstants) == 176);

GpuCamera toGpu(const scene::Camera& camera, uint32_t width, uint32_t height);

}  // namespace weir::execute
