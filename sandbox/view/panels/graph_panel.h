// The graph as a list of boxes in the order in which passes run, with edges beside them: this frame's on the left, last
// frame's dashed on the right. The selected pass shows its parameters.
#pragma once

#include "view/document/edits.h"
#include "view/document/model.h"
#include "view/panels/param_widgets.h"
#include "view/ui/ui.h"

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace weir::view {

struct GraphPanelState {
  // What the owner says, each frame if it likes.
  std::map<std::string, double, std::less<>> gpuMs;  ///< by pass, milliseconds; what is missing is not shown
  std::string shown;                                 ///< "pass.port" whose picture is on show

  // The panel's own.
  std::string selected;  ///< the pass whose parameters are open; may be set from outside too
  std::string hovered;   ///< the pass under the mouse in the last frame
  std::string revealed;  ///< a pass to scroll to
  ParamWidgetState widget;
  bool namesFile = false;  ///< the line for another file is open
  std::string otherFile;
};

/// What the user asked for in this frame; the panel itself changes nothing.
struct GraphRequests {
  std::vector<Edit> edits;  ///< for carryOut(), in this order
  std::string show;         ///< "pass.port" whose picture is wanted
  std::string choicesOf;    ///< a pass whose choices of type the next model should have
  bool save = false;        ///< to the document's own file
  std::string saveAs;       ///< to this one
};

/// Draws into the window that is open, over all of its width that is left, and scrolls by itself. Marks, all below
/// "graph/": save, save_as, save_path, save_ok, undo, redo, problem/I; PASS (a click opens it), PASS/enabled,
/// PASS/port/OUTPUT, PASS/input/INPUT; of the open pass also PASS/type, PASS/type/TYPE while the list is open,
/// PASS/source/INPUT, and PASS/PARAM with PASS/PARAM/reset and PASS/PARAM/CHOICE.
GraphRequests drawGraphPanel(Ui& ui, const GraphModel& model, GraphPanelState& state);

}  // namespace weir::view
