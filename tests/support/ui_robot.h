// A user of panels without a window: the app's own events go in, frames are drawn into nothing, and widgets are found
// by their names.
#pragma once

#include "view/input/event.h"
#include "view/ui/platform.h"
#include "view/ui/ui.h"

#include <functional>
#include <string>

namespace weir::test {

class UiRobot {
 public:
  /// `draw`: everything between the beginning and the end of a frame. One robot at a time in a process.
  explicit UiRobot(std::function<void(view::Ui&)> draw, glm::vec2 size = {1280.0f, 720.0f}, bool named = true);

  void frame(int count = 1);
  /// Seconds of CPU time that the last frame took, from its beginning to its draw lists.
  double seconds() const { return seconds_; }
  /// Triangles that it would draw.
  int triangles() const { return triangles_; }

  /// Whether a widget of that name was drawn in the last frame.
  bool has(const std::string& name) const { return marks_.find(name).has_value(); }
  /// Where it lies. Fails the test, with the names that there are, when there is none, and scrolls to it where that
  /// shows it.
  view::Rectangle where(const std::string& name);

  void moveTo(const std::string& name);
  void click(const std::string& name, view::Modifiers modifiers = {});
  void doubleClick(const std::string& name);
  /// Presses in the middle of the widget, moves in so many steps, lets go.
  void drag(const std::string& name, glm::vec2 by, int steps = 4);
  void press(const std::string& name, view::Modifiers modifiers = {});
  void release(view::Modifiers modifiers = {});
  void type(const std::string& utf8);
  void key(view::Key key, view::Modifiers modifiers = {});
  view::Marks& marks() { return marks_; }

 private:
  void button(bool down, view::Modifiers modifiers);
  void rest();
  std::function<void(view::Ui&)> draw_;
  glm::vec2 size_;
  view::UiPlatform platform_{1.0f, {}};
  view::Marks marks_;
  double seconds_ = 0.0;
  int triangles_ = 0;
};

}  // namespace weir::test
