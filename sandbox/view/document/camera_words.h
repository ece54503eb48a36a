// A camera as `--camera` takes it.
#pragma once

#include <weir/scene/scene.h>

#include <string>

namespace weir::view {

struct CameraWords {
  std::string text;    ///< "ex,ey,ez,tx,ty,tz,vfov"
  bool exact = false;  ///< reading it gives this very camera, to the last bit
  bool level = true;   ///< false: it is rolled about its axis, which the words can't say
};

/// The words that read as the camera nearest to this one. A camera that was read from such words is found again exactly
/// nearly always: one to be shared should be made from its own words.
CameraWords cameraWords(const scene::Camera& camera);

}  // namespace weir::view
