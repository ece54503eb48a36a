// What the user asked for in the panels, as plain data: the app carries it out between two frames.
#pragma once

#include "view/engine/messages.h"

#include <weir/scene/scene.h>

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <variant>
#include <vector>

namespace weir::view {

struct OpenGraph {
  std::string file;
};
struct OpenScene {
  std::string file;
};
struct SaveGraph {
  std::string file;
};                 ///< empty: where it came from
struct Revert {};  ///< takes what the graph's file says
struct OpenSecond {
  std::string file;
};  ///< graph or picture for the right side; empty: none
struct SetReference {
  std::string file;
};  ///< graph or picture that errors are measured against; empty: none
struct SaveTrail {
  std::string file;
};
struct SaveShot {
  std::string file;
};  ///< .png or .exr of the shown output
struct SaveSequence {
  std::string folder;
  uint32_t frames = 60;
};
struct CopyCommand {};
struct Quit {};
struct SetPaused {
  bool paused;
};
struct StepFrame {};
struct Restart {};
struct RunFrames {
  uint32_t frames;
};
struct SetCountRays {
  bool count;
};
struct SetPacing {
  int pacing;
};  ///< view::Pacing
struct SetRenderScale {
  float scale;
};
struct SetFixedSize {
  glm::uvec2 size;
};  ///< 0: follows the window
struct ChooseCamera {
  int index;
};  ///< of the scene; -1: frames everything
struct SetFieldOfView {
  float degrees;
};
struct SetSpeed {
  float metresPerSecond;
};
struct SetLight {
  size_t index;
  scene::PunctualLight light;
};
struct SetSeconds {
  double seconds;
};
struct SetPlays {
  bool plays;
};
struct ChooseClip {
  int index;
};                       ///< -1: at rest
struct SetSceneLights {  ///< `--lights N --replace-lights`; 0: the scene's own
  uint32_t count, seed;
};
struct Dismiss {
  uint64_t message;
};
struct CancelWork {};  ///< a sequence that is being written

using Request = std::variant<OpenGraph, OpenScene, SaveGraph, Revert, OpenSecond, SetReference, SaveTrail, SaveShot,
                             SaveSequence, CopyCommand, Quit, SetPaused, StepFrame, Restart, RunFrames, SetCountRays,
                             SetPacing, SetRenderScale, SetFixedSize, ChooseCamera, SetFieldOfView, SetSpeed, SetLight,
                             SetSeconds, SetPlays, ChooseClip, SetSceneLights, Dismiss, CancelWork>;
using Requests = std::vector<Request>;

}  // namespace weir::view
