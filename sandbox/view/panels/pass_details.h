// The open pass of the graph panel: type, documentation, what its inputs read, parameters, what is wrong.
#pragma once

#include "view/panels/pass_box.h"

namespace weir::view {

/// `width`: that rows may take.
void drawPassDetails(const PassFrame& frame, const PassModel& pass, float width);

}  // namespace weir::view
