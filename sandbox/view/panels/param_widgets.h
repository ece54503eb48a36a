// Widgets made from what a pass says of its parameters: kind, range, unit, documentation.
#pragma once

#include "view/document/model.h"
#include "view/ui/ui.h"

#include <optional>
#include <string>

namespace weir::view {

/// The widget that somebody is at. It shows its own value until it is let go, as the graph may be slower.
struct ParamWidgetState {
  std::string active;  ///< "pass.param"; empty: none
  ParamValue value;
  bool sent = false;  ///< some of the change has been asked for already
};

struct ParamRequest {
  std::optional<ParamValue> value;
  bool continues = false;  ///< part of the same movement as the last
  bool reset = false;
};

/// One row: changed mark, name, widget, button that resets. Numbers with a range are sliders, by the logarithm where
/// the range is positive and spans decades; a double click or Ctrl+click takes digits, which are kept within the range
/// and otherwise as typed. Values that a slider passes are asked for at once, unless each would rebuild pipelines;
/// typed ones when they are done. Marks: NAME, NAME/reset, NAME/CHOICE while a list is open. `width`: that the row
/// takes.
ParamRequest drawParam(Ui& ui, const std::string& pass, const ParamModel& param, float width, ParamWidgetState& state);

/// A value that a mouse chose, to as many digits as it can mean. Within the range if it was.
float rounded(float value, const ParamDescription& param);
/// Whether a slider goes by the logarithm.
bool isLogarithmic(const ParamDescription& param);

}  // namespace weir::view
