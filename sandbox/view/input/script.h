// A scripted session: what a user would do, one step a line, for tests and for pictures in the documentation. Its input
// is injected as the app's own events; widgets are named as ui/marks.h has them.
//
//   # a comment; words with spaces stand in "quotes", with \" \\ and \n inside
//   click NAME                  press and release on a widget
//   click-right NAME            the same with the right button
//   double-click NAME
//   drag NAME DX DY             press on it, move by so many units, release
//   look DX DY                  the same on the picture, with the left button; `look right DX DY` and `middle` with
//   others point NAME                  moves the mouse over it scroll NAME STEPS set NAME VALUE Ctrl-click, so that a
//   slider takes text; then the text and Enter text VALUE                  types into what has the focus key KEY "s",
//   "f1", "ctrl+shift+z": pressed and released hold KEY FRAMES             held down for so many frames of the window
//   drop FILE...                onto the window
//   size W H                    of the window, in window coordinates
//   minimise | restore
//   wait FRAMES                 frames of the window
//   until-frames N              until the graph has rendered so many since its last restart
//   until-idle                  until nothing is being loaded
//   expect NAME                 a widget is there; `expect-no NAME` it is not
//   expect-message TEXT         a message has this in it; `expect-no-messages` no error or warning is shown
//   edit FILE FROM TO           replaces the first FROM in a file, as an editor would
//   shoot FILE.png              the whole window
//   measure FILE.json           what the window took of the CPU since the last restart of measuring
//   quit
//
// A step that finds nothing within its patience ends the program with status 1 and the script's line.
#pragma once

#include "view/input/event.h"
#include "view/ui/marks.h"

#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <vector>

namespace weir::view {

struct ScriptStep {
  int line = 0;
  std::string command;
  std::vector<std::string> words;
};

/// InputError with file and line for unknown commands (naming the nearest), missing or malformed words.
std::vector<ScriptStep> readScript(const std::string& file);
std::vector<ScriptStep> parseScript(const std::string& text, const std::string& file);

/// What the app does for a script that is no input event.
struct ScriptHost {
  std::function<void(glm::ivec2)> setWindowSize;
  std::function<void(bool)> minimise;
  std::function<uint32_t()> framesRendered;
  std::function<bool()> idle;
  std::function<std::vector<std::string>(bool problemsOnly)> messages;
  std::function<void(const std::string& file)> shoot;
  std::function<bool()> shooting;  ///< a shot is not written yet
  std::function<void(const std::string& file)> measure;
  std::function<void()> quit;
};

class ScriptPlayer {
 public:
  ScriptPlayer(std::vector<ScriptStep> steps, std::string file, Marks& marks, ScriptHost host);

  /// Before each frame of the window: the events that it gets. Throws RuntimeError when a step can't be done.
  std::vector<Event> next();
  /// Whether the next call looks at the marks of the frame before it.
  bool looks() const { return queue_.empty(); }
  bool done() const { return at_ >= steps_.size() && queue_.empty(); }

 private:
  struct Turn {
    std::vector<Event> events;
  };
  bool begin(const ScriptStep& step);
  bool beginInput(const ScriptStep& step);
  bool beginWaiting(const ScriptStep& step);
  void beginAction(const ScriptStep& step);
  bool find(const std::string& name, glm::vec2& at);
  void press(glm::vec2 at, MouseButton button, Modifiers modifiers = {});
  void release(MouseButton button);
  void type(const std::string& text);
  void strike(Key key, Modifiers modifiers);
  void turn(std::vector<Event> events) { queue_.push_back({std::move(events)}); }
  [[noreturn]] void fail(const ScriptStep& step, const std::string& what) const;

  std::vector<ScriptStep> steps_;
  std::string file_;
  Marks& marks_;
  ScriptHost host_;
  size_t at_ = 0;
  std::deque<Turn> queue_;  ///< of the step that is being done, a frame each
  uint32_t patience_ = 0;   ///< frames that the step has been tried
};

}  // namespace weir::view
