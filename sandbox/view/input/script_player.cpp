#include "view/input/script.h"

#include <weir/core/error.h>
#include <weir/core/text.h>
#include <weir/image/atomic_file.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <utility>

namespace weir::view {
namespace {

/// Frames of the window that a step may take until what it looks for is there.
constexpr uint32_t kPatience = 400;
/// And that a picture or a scene may take.
constexpr uint32_t kLongPatience = 20000;

float number(const std::string& text) {
  return std::strtof(text.c_str(), nullptr);
}

/// "ctrl+shift+z" → its last part and what is held with it; None when it is no key.
std::pair<Key, Modifiers> chord(const std::string& text) {
  Modifiers held;
  std::string rest = text;
  for (size_t plus = rest.find('+'); plus != std::string::npos && plus + 1 < rest.size(); plus = rest.find('+')) {
    const Key key = keyNamed(rest.substr(0, plus));
    held.control |= key == Key::Control;
    held.shift |= key == Key::Shift;
    held.alt |= key == Key::Alt;
    rest = rest.substr(plus + 1);
  }
  return {keyNamed(rest), held};
}

void editFile(const std::string& file, const std::string& from, const std::string& to) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream read;
  read << stream.rdbuf();
  if (!stream) throw RuntimeError(fmt::format("edit {}: can't be read", file));
  std::string text = read.str();
  const size_t at = text.find(from);
  if (at == std::string::npos) throw RuntimeError(fmt::format("edit {}: there is no '{}' in it", file, from));
  text.replace(at, from.size(), to);
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out << text;
  if (!out.flush()) throw RuntimeError(fmt::format("edit {}: can't be written", file));
}

}  // namespace

ScriptPlayer::ScriptPlayer(std::vector<ScriptStep> steps, std::string file, Marks& marks, ScriptHost host)
    : steps_(std::move(steps)), file_(std::move(file)), marks_(marks), host_(std::move(host)) {}

void ScriptPlayer::fail(const ScriptStep& step, const std::string& what) const {
  std::string line = step.command;
  for (const std::string& word : step.words) line += " " + word;
  throw RuntimeError(fmt::format("{}:{}: {}: {}", file_, step.line, line, what));
}

std::vector<Event> ScriptPlayer::next() {
  while (queue_.empty() && at_ < steps_.size()) {
    const ScriptStep step = steps_[at_];
    ++patience_;
    if (!begin(step)) return {};  // tried again with the next frame
    patience_ = 0;
    ++at_;
  }
  if (queue_.empty()) return {};
  std::vector<Event> events = std::move(queue_.front().events);
  queue_.pop_front();
  return events;
}

/// False while what the step wants is not there yet.
bool ScriptPlayer::find(const std::string& name, glm::vec2& at) {
  const std::optional<Marks::Found> found = marks_.find(name);
  if (found && found->visible) {
    at = found->where.centre();
    return true;
  }
  marks_.reveal(name);
  if (patience_ > kPatience) {
    if (found) throw RuntimeError(fmt::format("'{}' can't be scrolled into view", name));
    const std::string nearest = nearestName(name, marks_.names());
    throw RuntimeError(fmt::format("no widget '{}'{}", name, nearest.empty() ? "" : "; nearest is '" + nearest + "'"));
  }
  return false;
}

void ScriptPlayer::press(glm::vec2 at, MouseButton button, Modifiers modifiers) {
  turn({mouseMove(at)});
  turn({});  // what the mouse is over, ImGui knows a frame later
  turn({mouseButton(button, true, modifiers)});
}

void ScriptPlayer::release(MouseButton button) {
  turn({mouseButton(button, false)});
  turn({});
}

void ScriptPlayer::type(const std::string& text) {
  std::vector<Event> events;
  for (const char32_t character : charactersOf(text)) events.push_back(textEvent(character));
  turn(std::move(events));
}

void ScriptPlayer::strike(Key key, Modifiers modifiers) {
  turn({keyEvent(key, true, modifiers)});
  turn({keyEvent(key, false, {})});
}

bool ScriptPlayer::begin(const ScriptStep& step) {
  try {
    if (beginWaiting(step)) return queue_.empty() ? patience_ == 0 : true;
    if (beginInput(step)) return true;
  } catch (const RuntimeError& error) {
    fail(step, error.what());
  }
  return false;
}

/// Whether it is a step that waits or looks; patience_ is 0 when it is over.
bool ScriptPlayer::beginWaiting(const ScriptStep& step) {
  const std::string& c = step.command;
  const auto finished = [&](bool is, uint32_t patience, const std::string& otherwise) {
    if (!is && patience_ > patience) throw RuntimeError(otherwise);
    if (is) patience_ = 0;
    return true;
  };
  if (c == "wait") {
    for (auto i = static_cast<int>(number(step.words[0])); i > 0; --i) turn({});
    patience_ = 0;
    return true;
  }
  if (c == "until-frames")
    return finished(host_.framesRendered() >= static_cast<uint32_t>(number(step.words[0])), kLongPatience,
                    fmt::format("only {} were rendered", host_.framesRendered()));
  if (c == "until-idle") return finished(host_.idle(), kLongPatience, "something is still being loaded");
  if (c == "expect") return finished(marks_.find(step.words[0]).has_value(), kPatience, "it is not there");
  if (c == "expect-no") return finished(!marks_.find(step.words[0]).has_value(), kPatience, "it is there");
  if (c == "expect-message") {
    std::string all;
    bool has = false;
    for (const std::string& text : host_.messages(false)) {
      has = has || text.find(step.words[0]) != std::string::npos;
      all += "\n  " + text;
    }
    return finished(has, kPatience, "the messages are:" + all);
  }
  if (c == "expect-no-messages") {
    const std::vector<std::string> problems = host_.messages(true);
    return finished(problems.empty(), kPatience, problems.empty() ? "" : "there is: " + problems.front());
  }
  return false;
}

bool ScriptPlayer::beginInput(const ScriptStep& step) {
  const std::string& c = step.command;
  const std::vector<std::string>& w = step.words;
  glm::vec2 at(0.0f);
  if (c == "click" || c == "click-right" || c == "double-click" || c == "drag" || c == "point" || c == "scroll" ||
      c == "set") {
    if (!find(w[0], at)) return false;
  }
  if (c == "click" || c == "click-right") {
    const MouseButton button = c == "click" ? MouseButton::Left : MouseButton::Right;
    press(at, button);
    release(button);
  } else if (c == "double-click") {
    press(at, MouseButton::Left);
    turn({mouseButton(MouseButton::Left, false)});
    turn({mouseButton(MouseButton::Left, true)});
    release(MouseButton::Left);
  } else if (c == "drag" || c == "look") {
    MouseButton button = MouseButton::Left;
    if (c == "look") {
      if (!find("picture", at)) return false;
      if (w.size() == 3)
        button = w[0] == "right" ? MouseButton::Right : w[0] == "middle" ? MouseButton::Middle : MouseButton::Left;
    }
    const glm::vec2 by(number(w[w.size() - 2]), number(w[w.size() - 1]));
    press(at, button);
    for (int i = 1; i <= 4; ++i) turn({mouseMove(at + by * (static_cast<float>(i) / 4.0f))});
    release(button);
  } else if (c == "point") {
    turn({mouseMove(at)});
    turn({});
  } else if (c == "scroll") {
    turn({mouseMove(at)});
    turn({});
    turn({scrollEvent({0.0f, number(w[1])})});
    turn({});
  } else if (c == "set") {
    press(at, MouseButton::Left, {.control = true});
    release(MouseButton::Left);
    strike(Key::A, {.control = true});
    type(w[1]);
    strike(Key::Enter, {});
    turn({});
  } else if (c == "text") {
    type(w[0]);
  } else if (c == "key" || c == "hold") {
    const auto [key, held] = chord(w[0]);
    if (key == Key::None) throw RuntimeError("there is no such key");
    turn({keyEvent(key, true, held)});
    for (int i = c == "hold" ? static_cast<int>(number(w[1])) : 1; i > 0; --i) turn({});
    turn({keyEvent(key, false, {})});
  } else if (c == "drop") {
    turn({dropEvent(w)});
  } else {
    beginAction(step);
    // A shot is of a frame to come.
    if (c == "shoot" && host_.shooting()) return false;
  }
  return true;
}

void ScriptPlayer::beginAction(const ScriptStep& step) {
  const std::string& c = step.command;
  if (c == "size") {
    host_.setWindowSize({static_cast<int>(number(step.words[0])), static_cast<int>(number(step.words[1]))});
    for (int i = 0; i < 6; ++i) turn({});
  } else if (c == "minimise" || c == "restore") {
    host_.minimise(c == "minimise");
    for (int i = 0; i < 4; ++i) turn({});
  } else if (c == "edit") {
    editFile(step.words[0], step.words[1], step.words[2]);
  } else if (c == "shoot") {
    if (patience_ == 1) host_.shoot(step.words[0]);
  } else if (c == "measure") {
    host_.measure(step.words[0]);
  } else if (c == "quit") {
    host_.quit();
  }
}

}  // namespace weir::view
