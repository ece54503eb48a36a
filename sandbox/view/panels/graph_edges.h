// The edges of the graph panel, beside the boxes.
#pragma once

#include "view/panels/pass_box.h"

#include <string>
#include <vector>

namespace weir::view {

/// `left` and `right`: room beside the boxes. `highlighted`: a pass whose edges stand out; empty: none.
void drawEdges(const GraphModel& model, const std::vector<PassAnchors>& anchors, const std::string& highlighted,
               float left, float right);

}  // namespace weir::view
