// Where the panels lie: a column on each side, the times below, the picture in what is left.
#pragma once

#include "view/ui/marks.h"

#include <glm/glm.hpp>

namespace weir::view {

struct LayoutState {
  bool graph = true, side = true, times = true;                         ///< which panels are shown
  bool all = true;                                                      ///< false: the picture alone
  float graphWidth = 340.0f, sideWidth = 310.0f, timesHeight = 150.0f;  ///< before scaling
};

struct Layout {
  Rectangle picture, graph, side, times;  ///< window coordinates; empty ones are not shown
};

/// `menuHeight` in window coordinates, `scale` as in Ui. The picture keeps at least a third of the window each way:
/// then panels are narrower, or not shown.
Layout layoutOf(glm::vec2 window, float menuHeight, float scale, const LayoutState& state);

}  // namespace weir::view
