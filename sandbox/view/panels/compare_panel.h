// What the shown picture is compared with, how far it is from it, and where that leaves it in the plane of error
// against time.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "view/compare/comparison.h"
#include "view/ui/ui.h"

namespace weir::view {

struct ComparePanelModel {
  const ComparisonState* state = nullptr;
  std::vector<std::pair<std::string, std::string>> references;  ///< what to choose from: what it is for, and the file
  std::string reference;                                        ///< its file; empty: none
  std::optional<double> frameMilliseconds;                      ///< that a frame of the reference takes
};

struct ComparePanelResult {
  std::optional<std::string> reference;  ///< a file: graph or EXR; empty: none
  std::optional<double> budget;          ///< milliseconds of each frame
  std::optional<bool> flip;
  bool browse = false;  ///< a file is to be chosen in the dialog
  bool startOver = false, forgetTrail = false, copyTrail = false, saveTrail = false;
};

/// Draws into the window that is open.
ComparePanelResult drawComparePanel(Ui& ui, const ComparePanelModel& model);

}  // namespace weir::view
