#include "view/engine/camera_control.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace weir::view {
namespace {

constexpr float kSteepest = 1.55f;  // radians from the horizon: straight up has no right and left

/// Lengths of the scene's own size, whatever its unit.
float sizeOf(const scene::Bounds& bounds) {
  const float radius = bounds.radius();
  return radius > 0.0f ? radius : 1.0f;
}

}  // namespace

CameraControl::CameraControl(const scene::Camera& camera, const std::string& words, const scene::Bounds& bounds)
    : bounds_(bounds) {
  speed_ = 0.3f * sizeOf(bounds);
  set(camera, words);
}

void CameraControl::set(const scene::Camera& camera, const std::string& words) {
  camera_ = camera;
  eye_ = camera.eye;
  degrees_ = glm::degrees(camera.verticalFov);
  // What it looks at is as far away as the scene's middle is along its view, and never right before it.
  const float size = sizeOf(bounds_);
  const float middle = glm::dot(bounds_.centre() - eye_, camera.forward);
  target_ = eye_ + camera.forward * std::clamp(middle, 0.1f * size, 4.0f * size);
  text_ = words;
  untouched_ = true;
  ++revision_;
}

/// Eye, target and angle are what `--camera` says in words; the camera is made of those words alone.
void CameraControl::settle() {
  if (!(glm::distance(eye_, target_) > 0.0f)) target_ = eye_ + camera_.forward * sizeOf(bounds_);
  text_ = fmt::format("{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}", eye_.x, eye_.y, eye_.z, target_.x, target_.y,
                      target_.z, degrees_);
  camera_ = scene::chooseCamera(scene::Scene{}, text_, 1.0f, &bounds_);
  untouched_ = false;
  ++revision_;
}

void CameraControl::frame(float aspect) {
  const scene::Camera whole = scene::framingCamera(bounds_, aspect);
  degrees_ = glm::degrees(whole.verticalFov);
  target_ = bounds_.centre();
  const float distance = glm::distance(whole.eye, target_);
  eye_ = target_ - camera_.forward * (distance > 0.0f ? distance : sizeOf(bounds_));
  settle();
}

/// The direction of view, turned to the right and up.
glm::vec3 CameraControl::turned(glm::vec2 angles) const {
  const glm::vec3 forward = glm::normalize(target_ - eye_);
  const float yaw = std::atan2(forward.x, -forward.z) + angles.x;
  const float pitch = std::clamp(std::asin(std::clamp(forward.y, -1.0f, 1.0f)) + angles.y, -kSteepest, kSteepest);
  return {std::sin(yaw) * std::cos(pitch), std::sin(pitch), -std::cos(yaw) * std::cos(pitch)};
}

void CameraControl::orbit(glm::vec2 angles) {
  eye_ = target_ - turned(angles) * glm::distance(eye_, target_);
  settle();
}

void CameraControl::look(glm::vec2 angles) {
  target_ = eye_ + turned(angles) * glm::distance(eye_, target_);
  settle();
}

void CameraControl::pan(glm::vec2 shares) {
  const glm::vec3 right = glm::normalize(glm::cross(camera_.forward, camera_.up));
  const float height = 2.0f * std::tan(0.5f * camera_.verticalFov) * glm::distance(eye_, target_);
  const glm::vec3 by = (camera_.up * shares.y - right * shares.x) * height;
  eye_ += by;
  target_ += by;
  settle();
}

void CameraControl::approach(float steps) {
  const float before = glm::distance(eye_, target_), size = sizeOf(bounds_);
  const float after = std::clamp(before * std::pow(0.9f, steps), 1e-4f * size, 100.0f * size);
  eye_ = target_ + (eye_ - target_) * (after / before);
  settle();
}

void CameraControl::fly(const glm::vec3& direction, float seconds) {
  const glm::vec3 right = glm::normalize(glm::cross(camera_.forward, camera_.up));
  const glm::vec3 by =
      (right * direction.x + glm::vec3(0.0f, 1.0f, 0.0f) * direction.y + camera_.forward * direction.z) *
      (speed_ * seconds);
  eye_ += by;
  target_ += by;
  settle();
}

void CameraControl::setFieldOfView(float degrees) {
  degrees_ = std::clamp(degrees, 1.0f, 170.0f);
  settle();
}

void CameraControl::setSpeed(float metresPerSecond) {
  const float size = sizeOf(bounds_);
  speed_ = std::clamp(metresPerSecond, 1e-3f * size, 10.0f * size);
}

float CameraControl::fieldOfView() const {
  return degrees_;
}

}  // namespace weir::view
