// What of the graph is shown, and how: the port, its channel, range, exposure, and what it holds under the mouse.
#pragma once

#include "view/picture/channels.h"
#include "view/picture/mode.h"
#include "view/picture/range_meter.h"
#include "view/picture/words.h"
#include "view/ui/ui.h"

#include <optional>
#include <string>
#include <vector>

namespace weir::view {

/// One side of the picture.
struct SideModel {
  std::vector<std::string> ports;  ///< that can be shown, "pass.port"; outputs of the graph first
  std::string port;                ///< that is shown
  std::string what;                ///< in words: type, size, bytes
  const std::vector<Channel>* channels = nullptr;
  size_t channel = 0;
  PictureMode mode;
  uint32_t elements = 1;  ///< of a pixel
  std::optional<Measurement> measured;
  std::string problem;  ///< why nothing is shown
};

struct PicturePanelModel {
  SideModel a;
  glm::uvec2 size{0};  ///< of the rendered pictures, pixels
  float zoom = 1.0f;   ///< canvas pixels for one of the picture's
  bool fitted = true;
  float renderScale = 1.0f;
  glm::uvec2 fixedSize{0};          ///< 0: it follows the window
  std::optional<PixelPlace> pixel;  ///< under the mouse, or pinned
  bool pinned = false;
  const std::vector<Row>* words = nullptr;
  int pacing = 0;
  std::vector<std::string> pacings;
};

struct PicturePanelResult {
  std::optional<std::string> port;
  std::optional<size_t> channel;
  std::optional<PictureMode> mode;
  std::optional<float> zoom;  ///< 0: fit
  std::optional<float> renderScale;
  std::optional<glm::uvec2> fixedSize;
  std::optional<int> pacing;
  bool measure = false, resetMode = false;
};

/// Draws into the window that is open.
PicturePanelResult drawPicturePanel(Ui& ui, const PicturePanelModel& model);

}  // namespace weir::view
