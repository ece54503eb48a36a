// What every panel gets to draw with.
#pragma once

#include "view/ui/marks.h"

namespace weir::view {

struct Ui {
  Marks& marks;
  float scale = 1.0f;  ///< of fonts and spaces: 2 on a display with twice as many pixels an inch
};

}  // namespace weir::view
