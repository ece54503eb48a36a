// One pass of the graph panel: its box, ports, and when it is open its type and parameters.
#pragma once

#include "view/panels/graph_panel.h"

#include <glm/glm.hpp>
#include <vector>

namespace weir::view {

/// Where edges meet a box, in window coordinates: heights of its ports, on either side.
struct PassAnchors {
  Rectangle box;
  std::vector<float> inputs, outputs;
};

/// Everything that is drawn of the graph in a frame.
struct PassFrame {
  Ui& ui;
  const GraphModel& model;
  GraphPanelState& state;
  GraphRequests& requests;
};

/// `index`: of the pass in the model. `width`: of the box, from the cursor on.
PassAnchors drawPassBox(const PassFrame& frame, size_t index, float width);

}  // namespace weir::view
