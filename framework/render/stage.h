// Scene, camera and lights from command-line words to the device: what `render`, `bench` and `view` have in common.
#pragma once

#include <weir/execute/executor.h>
#include <weir/gpu/device.h>
#include <weir/scene/import.h>
#include <weir/scene/scene.h>
#include <weir/scene/upload.h>

#include <cstdint>
#include <optional>
#include <string>

namespace weir::render {

struct StageOptions {
  std::string scene;    ///< file
  uint32_t lights = 0;  ///< `--lights N`; 0: the scene's own
  uint32_t lightSeed = 1;
  bool replaceLights = false;  ///< drop the scene's own lights, emissive triangles included
  std::string environment;     ///< file, .exr or .hdr; empty: none
  float environmentScale = 1.0f, environmentRotation = 0.0f;  ///< degrees about +Y, counter-clockwise from above
  std::string camera;                                         ///< as `--camera`
  bool energyCompensation = false;  ///< of specular lobes, for light reflected more than once (docs/materials.md)
  bool animate = false;             ///< `--animate`: frame i shows the clip at time + i · timeStep
  std::string clip;                 ///< name or number; empty: the first
  double time = 0.0, timeStep = 1.0 / 60.0;  ///< seconds
  bool operator==(const StageOptions&) const = default;
};

/// A clip and the times at which frames show it. It starts over when it ends.
struct Playback {
  size_t clip = 0;
  double start = 0.0, step = 0.0;  ///< seconds
  double time(uint64_t frame) const { return start + static_cast<double>(frame) * step; }
};

/// A scene as the user asked for it, still plain data.
struct Stage {
  scene::Scene scene;
  scene::PreparedScene prepared;
  scene::Camera camera;
  std::string sceneLabel;   ///< file name and content hash: tells pictures of different scenes apart
  std::string lightsLabel;  ///< "scene" or "500 points, seed 1"; then the environment's name and content hash
  std::string cameraLabel;
  std::string shadingLabel;          ///< by which model surfaces reflect
  std::optional<Playback> playback;  ///< none: the scene stays at rest
  scene::ImportTimes importTimes;
  double environmentSeconds = 0.0, prepareSeconds = 0.0;
};

/// Reads, lights, arranges. `aspect`: width / height, for a camera that frames the scene. Throws InputError.
Stage makeStage(const StageOptions& options, float aspect);

/// What frames of a stage show: its camera, and its scene where the clip has taken it. The stage must outlive it.
class Player {
 public:
  explicit Player(const Stage& stage);
  /// The input for a frame's number; valid until the next call.
  execute::FrameInput frame(uint32_t number, uint32_t seed);
  /// The same at a moment of the clip's, in seconds.
  execute::FrameInput frameAt(double seconds, uint32_t number, uint32_t seed);

 private:
  const Stage& stage_;
  std::optional<scene::StateMaker> states_;  // only where a clip moves the scene
  scene::SceneState state_;
};

/// InputError when the numbers of `count` frames from `first` on don't fit into 32 bits. `option`: what asks for them.
void requireFrameNumbers(uint32_t first, const char* option, uint32_t count);

/// What tells pictures of different moments apart, such as "Walk at 0.5 s"; empty without playback. `first` and `last`
/// are the numbers of the frames that a picture shows.
std::string animationLabel(const Stage& stage, uint64_t first, uint64_t last);

}  // namespace weir::render
