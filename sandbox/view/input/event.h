// What happens to the window, in the app's own terms: GLFW's callbacks make these, and scripts make the same ones.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace weir::view {

enum class Key : uint8_t {
  None,
  Tab,
  Left,
  Right,
  Up,
  Down,
  PageUp,
  PageDown,
  Home,
  End,
  Insert,
  Delete,
  Backspace,
  Space,
  Enter,
  Escape,
  F1,
  F2,
  F3,
  F4,
  F5,
  F6,
  F7,
  F8,
  F9,
  F10,
  F11,
  F12,
  Shift,
  Control,
  Alt,
  Minus,
  Equal,
  Digit0,
  Digit1,
  Digit2,
  Digit3,
  Digit4,
  Digit5,
  Digit6,
  Digit7,
  Digit8,
  Digit9,
  A,
  B,
  C,
  D,
  E,
  F,
  G,
  H,
  I,
  J,
  K,
  L,
  M,
  N,
  O,
  P,
  Q,
  R,
  S,
  T,
  U,
  V,
  W,
  X,
  Y,
  Z,
  Count
};
/// "F1", "a", "enter", …, upper or lower case; None when there is no such key.
Key keyNamed(const std::string& name);

/// Keys held down with another.
struct Modifiers {
  bool control = false, shift = false, alt = false;
  bool operator==(const Modifiers&) const = default;
};

enum class MouseButton : uint8_t { Left, Right, Middle, Count };

/// Positions are in window coordinates from its upper left corner, which are pixels unless the system scales windows.
struct Event {
  enum class Kind : uint8_t { MouseMove, MouseButton, MouseLeave, Scroll, Key, Text, Drop, Focus, Close };
  Kind kind = Kind::MouseMove;
  glm::vec2 position{0.0f};  ///< MouseMove; Scroll: steps to the right and up
  MouseButton button = MouseButton::Left;
  bool down = false;  ///< MouseButton, Key; Focus: whether the window has it
  Key key = Key::None;
  Modifiers modifiers;
  char32_t character = 0;          ///< Text
  std::vector<std::string> files;  ///< Drop
};

Event mouseMove(glm::vec2 position);
Event mouseButton(MouseButton button, bool down, Modifiers modifiers = {});
Event keyEvent(Key key, bool down, Modifiers modifiers = {});
Event textEvent(char32_t character);
Event scrollEvent(glm::vec2 steps);
Event dropEvent(std::vector<std::string> files);
/// The characters of UTF-8 text; what is none is left out.
std::vector<char32_t> charactersOf(const std::string& utf8);

}  // namespace weir::view
