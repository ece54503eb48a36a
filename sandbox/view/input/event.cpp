#include "view/input/event.h"

#include <array>
#include <cctype>
#include <string_view>
#include <utility>

namespace weir::view {

Key keyNamed(const std::string& name) {
  std::string lower;
  for (const char c : name) lower += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  constexpr std::array<std::pair<std::string_view, Key>, 21> kNames = {
      {{"tab", Key::Tab},         {"left", Key::Left},     {"right", Key::Right},       {"up", Key::Up},
       {"down", Key::Down},       {"pageup", Key::PageUp}, {"pagedown", Key::PageDown}, {"home", Key::Home},
       {"end", Key::End},         {"insert", Key::Insert}, {"delete", Key::Delete},     {"backspace", Key::Backspace},
       {"space", Key::Space},     {"enter", Key::Enter},   {"escape", Key::Escape},     {"shift", Key::Shift},
       {"control", Key::Control}, {"alt", Key::Alt},       {"minus", Key::Minus},       {"equal", Key::Equal},
       {"ctrl", Key::Control}}};
  for (const auto& [text, key] : kNames)
    if (lower == text) return key;
  const auto offset = [](Key first, int by) { return static_cast<Key>(static_cast<int>(first) + by); };
  if (lower.size() == 1 && lower[0] >= 'a' && lower[0] <= 'z') return offset(Key::A, lower[0] - 'a');
  if (lower.size() == 1 && lower[0] >= '0' && lower[0] <= '9') return offset(Key::Digit0, lower[0] - '0');
  for (int f = 1; f <= 12; ++f)
    if (lower == "f" + std::to_string(f)) return offset(Key::F1, f - 1);
  return Key::None;
}

Event mouseMove(glm::vec2 position) {
  Event event;
  event.position = position;
  return event;
}

Event mouseButton(MouseButton button, bool down, Modifiers modifiers) {
  Event event;
  event.kind = Event::Kind::MouseButton;
  event.button = button;
  event.down = down;
  event.modifiers = modifiers;
  return event;
}

Event keyEvent(Key key, bool down, Modifiers modifiers) {
  Event event;
  event.kind = Event::Kind::Key;
  event.key = key;
  event.down = down;
  event.modifiers = modifiers;
  return event;
}

Event textEvent(char32_t character) {
  Event event;
  event.kind = Event::Kind::Text;
  event.character = character;
  return event;
}

Event scrollEvent(glm::vec2 steps) {
  Event event;
  event.kind = Event::Kind::Scroll;
  event.position = steps;
  return event;
}

Event dropEvent(std::vector<std::string> files) {
  Event event;
  event.kind = Event::Kind::Drop;
  event.files = std::move(files);
  return event;
}

std::vector<char32_t> charactersOf(const std::string& utf8) {
  std::vector<char32_t> characters;
  for (size_t i = 0; i < utf8.size();) {
    const auto first = static_cast<unsigned char>(utf8[i++]);
    const int more = first < 0x80u              ? 0
                     : (first & 0xe0u) == 0xc0u ? 1
                     : (first & 0xf0u) == 0xe0u ? 2
                     : (first & 0xf8u) == 0xf0u ? 3
                                                : -1;
    if (more < 0) continue;
    char32_t value = more == 0 ? first : first & (0x3fu >> more);
    bool whole = true;
    for (int k = 0; k < more; ++k) {
      if (i >= utf8.size() || (static_cast<unsigned char>(utf8[i]) & 0xc0u) != 0x80u) {
        whole = false;
        break;
      }
      value = (value << 6u) | (static_cast<unsigned char>(utf8[i++]) & 0x3fu);
    }
    if (whole) characters.push_back(value);
  }
  return characters;
}

}  // namespace weir::view
