#include "view/document/camera_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace weir::view {
namespace {

/// Degrees that become these radians, or come nearest.
float degreesOf(float radians) {
  float best = glm::degrees(radians), error = std::numeric_limits<float>::infinity();
  float tried = best;
  for (int i = 0; i < 4; ++i) tried = std::nextafter(tried, 0.0f);
  for (int i = 0; i < 9; ++i, tried = std::nextafter(tried, std::numeric_limits<float>::infinity())) {
    const float difference = std::abs(glm::radians(tried) - radians);
    if (difference < error) best = tried, error = difference;
  }
  return best;
}

std::string written(const glm::vec3& v) {
  return fmt::format("{},{},{}", v.x, v.y, v.z);  // the shortest digits that read as the same float
}

scene::Camera read(const std::string& text) {
  return scene::chooseCamera(scene::Scene{}, text, 1.0f);
}

float distance(const scene::Camera& a, const scene::Camera& b) {
  return std::max(glm::length(a.forward - b.forward), glm::length(a.up - b.up));
}

}  // namespace

CameraWords cameraWords(const scene::Camera& camera) {
  CameraWords words;
  const std::string fov = fmt::format("{}", degreesOf(camera.verticalFov));
  float error = std::numeric_limits<float>::infinity();
  // Where the target lies on the axis is free, and its coordinates are rounded: of many, one gives the axis back.
  constexpr int kNearest = -2, kTries = 384, kTriesPerDoubling = 16;
  for (int i = 0; i < kTries && error > 0.0f; ++i) {
    const double away = std::exp2(kNearest + static_cast<double>(i) / kTriesPerDoubling);
    const glm::vec3 target(glm::dvec3(camera.eye) + away * glm::dvec3(camera.forward));
    if (target == camera.eye) continue;  // too far from the origin for so small a step
    const std::string text = fmt::format("{},{},{}", written(camera.eye), written(target), fov);
    const float found = distance(read(text), camera);
    if (found < error) error = found, words.text = text;
  }
  const scene::Camera again = read(words.text);
  words.exact = error == 0.0f && again.eye == camera.eye && again.verticalFov == camera.verticalFov;
  // Rounding turns the axis by some 1e-7; what is left at the hundredfold of that is meant.
  constexpr float kRolled = 1e-5f;
  words.level = glm::length(again.up - camera.up) < kRolled + glm::length(again.forward - camera.forward);
  return words;
}

}  // namespace weir::view
