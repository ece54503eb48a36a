// A camera that is moved by hand: round a point (orbit), or through the scene (fly). Every place it can be in has words
// for `--camera` that give the very same numbers, so that a picture can be rendered again without a window.
#pragma once

#include <weir/scene/scene.h>

#include <glm/glm.hpp>
#include <string>

namespace weir::view {

class CameraControl {
 public:
  /// `bounds` of the scene: how far a step goes. `words` of `--camera` that give this camera; empty: without any.
  CameraControl(const scene::Camera& camera, const std::string& words, const scene::Bounds& bounds);

  /// A camera as it is, until it is moved.
  void set(const scene::Camera& camera, const std::string& words);
  /// Looks from where it is at all of the bounds; `aspect` = width / height.
  void frame(float aspect);
  /// Turns round the point that it looks at; radians to the right and up.
  void orbit(glm::vec2 angles);
  /// Turns where it stands.
  void look(glm::vec2 angles);
  /// Moves sideways with the point it looks at, in parts of the picture's height, to the right and down.
  void pan(glm::vec2 shares);
  /// Towards the point it looks at; each step is a tenth of the way.
  void approach(float steps);
  /// To the right, up and ahead, for so many seconds at `speed()`.
  void fly(const glm::vec3& direction, float seconds);
  void setFieldOfView(float degrees);  ///< vertical, 1 … 170
  void setSpeed(float metresPerSecond);

  const scene::Camera& camera() const { return camera_; }
  float fieldOfView() const;  ///< vertical, degrees
  float speed() const { return speed_; }
  const glm::vec3& target() const { return target_; }
  /// For `--camera`: "ex,ey,ez,tx,ty,tz,vfov", or what it was set with if it was not moved since.
  const std::string& text() const { return text_; }
  /// It was not moved since it was set.
  bool untouched() const { return untouched_; }
  /// Counts changes.
  uint64_t revision() const { return revision_; }

 private:
  void settle();
  glm::vec3 turned(glm::vec2 angles) const;

  scene::Bounds bounds_;
  scene::Camera camera_;
  glm::vec3 eye_{0.0f}, target_{0.0f};
  float degrees_ = 45.0f, speed_ = 1.0f;
  std::string text_;
  bool untouched_ = true;
  uint64_t revision_ = 0;
};

}  // namespace weir::view
