// Scene, camera and lights from command-line words to the device: what `render`, `bench` and `view` have in common.
#pragma once

#include <weir/gpu/device.h>
#include <weir/scene/import.h>
#include <weir/scene/scene.h>
#include <weir/scene/upload.h>

#include <memory>
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
};

/// A scene as the user asked for it, still plain data.
struct Stage {
  scene::Scene scene;
  scene::PreparedScene prepared;
  scene::Camera camera;
  std::string sceneLabel;   ///< file name and content hash: tells pictures of different scenes apart
  std::string lightsLabel;  ///< "scene" or "500 points, seed 1"; then the environment's name and content hash
  std::string cameraLabel;
  scene::ImportTimes importTimes;
  double environmentSeconds = 0.0, prepareSeconds = 0.0;
};

/// Reads, lights, arranges. `aspect`: width / height, for a camera that frames the scene. Throws InputError.
Stage makeStage(const StageOptions& options, float aspect);

}  // namespace weir::render
