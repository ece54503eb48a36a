#include "ui_robot.h"

#include <gtest/gtest.h>
#include <imgui.h>

#include <ctime>

namespace weir::test {
namespace {

constexpr double kFrameSeconds = 1.0 / 60.0;

/// Of this thread alone, so that what else the machine does is not counted.
double cpuSeconds() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

UiRobot::UiRobot(std::function<void(view::Ui&)> draw, glm::vec2 size, bool named)
    : draw_(std::move(draw)), size_(size), marks_(named) {
  frame(2);  // ImGui knows sizes from the frame before
}

void UiRobot::frame(int count) {
  for (int i = 0; i < count; ++i) {
    const double begin = cpuSeconds();
    platform_.beginFrame(size_, {1.0f, 1.0f}, kFrameSeconds);
    marks_.begin();
    view::Ui ui{marks_, 1.0f};
    draw_(ui);
    ImGui::Render();
    seconds_ = cpuSeconds() - begin;
    triangles_ = ImGui::GetDrawData()->TotalIdxCount / 3;
  }
}

view::Rectangle UiRobot::where(const std::string& name) {
  auto found = marks_.find(name);
  if (found && !found->visible) {
    marks_.reveal(name);
    frame(3);
    found = marks_.find(name);
  }
  if (found) return found->where;
  std::string names;
  for (const std::string& other : marks_.names()) names += "\n  " + other;
  ADD_FAILURE() << "there is no widget '" << name << "'; there are:" << names;
  return {};
}

void UiRobot::moveTo(const std::string& name) {
  platform_.feed(view::mouseMove(where(name).centre()));
  frame();
}

void UiRobot::button(bool down, view::Modifiers modifiers) {
  platform_.feed(view::mouseButton(view::MouseButton::Left, down, modifiers));
  frame();
}

void UiRobot::press(const std::string& name, view::Modifiers modifiers) {
  moveTo(name);
  button(true, modifiers);
}

void UiRobot::release(view::Modifiers modifiers) {
  button(false, modifiers);
}

void UiRobot::click(const std::string& name, view::Modifiers modifiers) {
  press(name, modifiers);
  release(modifiers);
  rest();
}

/// What a script presses next is no double click with what it pressed before.
void UiRobot::rest() {
  frame(static_cast<int>(ImGui::GetIO().MouseDoubleClickTime / kFrameSeconds) + 1);
}

void UiRobot::doubleClick(const std::string& name) {
  press(name);
  release();
  button(true, {});
  release();
  frame(2);
}

void UiRobot::drag(const std::string& name, glm::vec2 by, int steps) {
  press(name);
  const glm::vec2 from = where(name).centre();
  for (int i = 1; i <= steps; ++i) {
    platform_.feed(view::mouseMove(from + by * (static_cast<float>(i) / static_cast<float>(steps))));
    frame();
  }
  release();
  rest();
}

void UiRobot::type(const std::string& utf8) {
  for (const char32_t character : view::charactersOf(utf8)) {
    platform_.feed(view::textEvent(character));
    frame();
  }
}

void UiRobot::key(view::Key key, view::Modifiers modifiers) {
  platform_.feed(view::keyEvent(key, true, modifiers));
  frame();
  platform_.feed(view::keyEvent(key, false, {}));
  frame(2);
}

}  // namespace weir::test
