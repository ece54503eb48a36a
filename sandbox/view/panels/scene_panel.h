// What the scene has in it: figures, cameras, lights to move and colour, the clip's time.
#pragma once

#include "view/panels/requests.h"
#include "view/ui/ui.h"

#include <weir/render/stage.h>

#include <string>
#include <utility>
#include <vector>

namespace weir::view {

/// Made once a scene, not once a frame.
struct SceneModel {
  std::vector<std::pair<std::string, std::string>> facts;  ///< label, value
  std::vector<std::string> cameras, clips, warnings;
  bool hasOwnLights = false;
};
SceneModel describe(const render::Stage& stage, const render::StageOptions& options, uint64_t deviceBytes);

struct ScenePanelModel {
  const SceneModel* scene = nullptr;
  const std::vector<scene::PunctualLight>* lights = nullptr;  ///< the scene's, with the edits
  std::vector<bool> const* canMove = nullptr;                 ///< beside them
  float fieldOfView = 45.0f, speed = 1.0f;
  std::string camera;  ///< in words
  int clip = -1;
  double seconds = 0.0, duration = 0.0;
  bool plays = false, loading = false;
  uint32_t generated = 0, lightSeed = 1;  ///< `--lights`, `--light-seed`
};

struct ScenePanelState {
  size_t light = 0;    ///< chosen
  std::string filter;  ///< of lights' names
  int generate = 500, seed = 1;
};

/// Draws into the window that is open.
Requests drawScenePanel(Ui& ui, const ScenePanelModel& model, ScenePanelState& state);

}  // namespace weir::view
