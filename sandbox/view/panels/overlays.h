// What lies over everything: messages, the help on keys, and the choice of a file.
#pragma once

#include "view/panels/requests.h"
#include "view/ui/ui.h"

#include <functional>
#include <string>
#include <vector>

namespace weir::view {

/// Errors and news at the upper edge of the picture.
Requests drawMessages(Ui& ui, const Rectangle& picture, const std::vector<Message>& messages);

/// Keys and mouse; `open` is cleared by its button.
void drawHelp(Ui& ui, glm::vec2 window, bool& open);

/// Choosing a file by its name, or walking through folders to it.
struct FileDialog {
  enum class For : uint8_t {
    None,
    OpenGraph,
    OpenScene,
    OpenSecond,
    OpenReference,
    SaveTrail,
    SaveGraph,
    SaveShot,
    SaveSequence
  };
  For purpose = For::None;
  std::string path;
  std::string folder;  ///< whose entries are shown
  std::vector<std::string> folders, files;
  std::string problem;  ///< why the folder can't be shown
  int frames = 60;      ///< of a sequence
  void open(For what, const std::string& start);
  void enter(const std::string& folderPath);
};
Requests drawFileDialog(Ui& ui, glm::vec2 window, FileDialog& dialog);

/// What to do with a graph that is not saved.
enum class CloseAnswer : uint8_t { None, Save, Discard, Stay };
CloseAnswer drawCloseQuestion(Ui& ui, glm::vec2 window, bool& open);

}  // namespace weir::view
