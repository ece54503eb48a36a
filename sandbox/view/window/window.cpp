#include "view/window/window.h"

#include <weir/core/error.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace weir::view {
namespace {

std::string lastError() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text == nullptr ? "unknown reason" : text;
}

Key keyOf(int key) {
  const auto offset = [](Key first, int by) { return static_cast<Key>(static_cast<int>(first) + by); };
  if (key >= GLFW_KEY_A && key <= GLFW_KEY_Z) return offset(Key::A, key - GLFW_KEY_A);
  if (key >= GLFW_KEY_0 && key <= GLFW_KEY_9) return offset(Key::Digit0, key - GLFW_KEY_0);
  if (key >= GLFW_KEY_F1 && key <= GLFW_KEY_F12) return offset(Key::F1, key - GLFW_KEY_F1);
  constexpr std::array<std::pair<int, Key>, 24> kKeys = {{{GLFW_KEY_TAB, Key::Tab},
                                                          {GLFW_KEY_LEFT, Key::Left},
                                                          {GLFW_KEY_RIGHT, Key::Right},
                                                          {GLFW_KEY_UP, Key::Up},
                                                          {GLFW_KEY_DOWN, Key::Down},
                                                          {GLFW_KEY_PAGE_UP, Key::PageUp},
                                                          {GLFW_KEY_PAGE_DOWN, Key::PageDown},
                                                          {GLFW_KEY_HOME, Key::Home},
                                                          {GLFW_KEY_END, Key::End},
                                                          {GLFW_KEY_INSERT, Key::Insert},
                                                          {GLFW_KEY_DELETE, Key::Delete},
                                                          {GLFW_KEY_BACKSPACE, Key::Backspace},
                                                          {GLFW_KEY_SPACE, Key::Space},
                                                          {GLFW_KEY_ENTER, Key::Enter},
                                                          {GLFW_KEY_KP_ENTER, Key::Enter},
                                                          {GLFW_KEY_ESCAPE, Key::Escape},
                                                          {GLFW_KEY_LEFT_SHIFT, Key::Shift},
                                                          {GLFW_KEY_RIGHT_SHIFT, Key::Shift},
                                                          {GLFW_KEY_LEFT_CONTROL, Key::Control},
                                                          {GLFW_KEY_RIGHT_CONTROL, Key::Control},
                                                          {GLFW_KEY_LEFT_ALT, Key::Alt},
                                                          {GLFW_KEY_RIGHT_ALT, Key::Alt},
                                                          {GLFW_KEY_MINUS, Key::Minus},
                                                          {GLFW_KEY_EQUAL, Key::Equal}}};
  for (const auto& [theirs, ours] : kKeys)
    if (theirs == key) return ours;
  return Key::None;
}

Modifiers modifiersOf(int mods) {
  return {(mods & GLFW_MOD_CONTROL) != 0, (mods & GLFW_MOD_SHIFT) != 0, (mods & GLFW_MOD_ALT) != 0};
}

}  // namespace

WindowSystem::WindowSystem() {
  if (glfwInit() == GLFW_FALSE)
    throw RuntimeError("There can be no window: " + lastError() +
                       ". `weir render` needs none; xvfb-run gives a display to a machine without one.");
}

WindowSystem::~WindowSystem() {
  glfwTerminate();
}

std::vector<std::string> WindowSystem::vulkanExtensions() const {
  uint32_t count = 0;
  const char** names = glfwGetRequiredInstanceExtensions(&count);
  if (names == nullptr) throw RuntimeError("There can be no window: " + lastError());
  return {names, names + count};
}

Window::Window(const WindowSystem&, const std::string& title, glm::ivec2 size) {
  if (GLFWmonitor* monitor = glfwGetPrimaryMonitor()) {
    glm::ivec2 at(0), room(0);
    glfwGetMonitorWorkarea(monitor, &at.x, &at.y, &room.x, &room.y);
    if (room.x > 0 && room.y > 0) size = glm::min(size, room);
  }
  glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
  handle_ = glfwCreateWindow(size.x, size.y, title.c_str(), nullptr, nullptr);
  if (handle_ == nullptr) throw RuntimeError("There can be no window: " + lastError());
  constexpr std::array<int, 8> kShapes = {GLFW_ARROW_CURSOR,   GLFW_IBEAM_CURSOR,   GLFW_ARROW_CURSOR,
                                          GLFW_VRESIZE_CURSOR, GLFW_HRESIZE_CURSOR, GLFW_ARROW_CURSOR,
                                          GLFW_ARROW_CURSOR,   GLFW_HAND_CURSOR};
  for (const int shape : kShapes) cursors_.push_back(glfwCreateStandardCursor(shape));
  glfwSetWindowUserPointer(handle_, this);
  glfwSetWindowSizeLimits(handle_, 320, 240, GLFW_DONT_CARE, GLFW_DONT_CARE);
  listen();
  look();
}

Window::~Window() {
  for (GLFWcursor* cursor : cursors_) glfwDestroyCursor(cursor);
  glfwDestroyWindow(handle_);
}

Window& Window::of(GLFWwindow* handle) {
  return *static_cast<Window*>(glfwGetWindowUserPointer(handle));
}

void Window::listen() {
  glfwSetCursorPosCallback(handle_, [](GLFWwindow* w, double x, double y) {
    of(w).events_.push_back(mouseMove({static_cast<float>(x), static_cast<float>(y)}));
  });
  glfwSetCursorEnterCallback(handle_, [](GLFWwindow* w, int entered) {
    if (entered != GLFW_FALSE) return;
    Event event;
    event.kind = Event::Kind::MouseLeave;
    of(w).events_.push_back(event);
  });
  glfwSetMouseButtonCallback(handle_, [](GLFWwindow* w, int button, int action, int mods) {
    if (button > GLFW_MOUSE_BUTTON_MIDDLE) return;
    of(w).events_.push_back(mouseButton(static_cast<MouseButton>(button), action == GLFW_PRESS, modifiersOf(mods)));
  });
  glfwSetScrollCallback(handle_, [](GLFWwindow* w, double x, double y) {
    of(w).events_.push_back(scrollEvent({static_cast<float>(x), static_cast<float>(y)}));
  });
  glfwSetKeyCallback(handle_, [](GLFWwindow* w, int key, int, int action, int mods) {
    const Key ours = keyOf(key);
    if (ours == Key::None || action == GLFW_REPEAT) return;  // ImGui repeats by itself
    // A modifier's own event comes with the modifiers of before.
    Modifiers held = modifiersOf(mods);
    if (ours == Key::Control) held.control = action == GLFW_PRESS;
    if (ours == Key::Shift) held.shift = action == GLFW_PRESS;
    if (ours == Key::Alt) held.alt = action == GLFW_PRESS;
    of(w).events_.push_back(keyEvent(ours, action == GLFW_PRESS, held));
  });
  glfwSetCharCallback(handle_, [](GLFWwindow* w, unsigned c) { of(w).events_.push_back(textEvent(c)); });
  glfwSetDropCallback(handle_, [](GLFWwindow* w, int count, const char** files) {
    of(w).events_.push_back(dropEvent({files, files + count}));
  });
  glfwSetWindowFocusCallback(handle_, [](GLFWwindow* w, int focused) {
    Event event;
    event.kind = Event::Kind::Focus;
    event.down = focused != GLFW_FALSE;
    of(w).events_.push_back(event);
  });
  glfwSetWindowCloseCallback(handle_, [](GLFWwindow* w) {
    glfwSetWindowShouldClose(w, GLFW_FALSE);  // what is not saved may be asked for first
    Event event;
    event.kind = Event::Kind::Close;
    of(w).events_.push_back(event);
  });
}

VkSurfaceKHR Window::makeSurface(VkInstance instance) const {
  VkSurfaceKHR surface = VK_NULL_HANDLE;
  if (glfwCreateWindowSurface(instance, handle_, nullptr, &surface) != VK_SUCCESS)
    throw RuntimeError("There can be no window: " + lastError());
  return surface;
}

void Window::poll(double seconds) {
  if (seconds > 0.0)
    glfwWaitEventsTimeout(seconds);
  else
    glfwPollEvents();
  look();
}

std::vector<Event> Window::takeEvents() {
  return std::exchange(events_, {});
}

void Window::look() {
  glfwGetWindowSize(handle_, &size_.x, &size_.y);
  glfwGetFramebufferSize(handle_, &pixels_.x, &pixels_.y);
  // Where the framebuffer is larger than the window already, ImGui's own framebuffer scale sees to it.
  const float drawn = size_.x > 0 && pixels_.x > 0 ? static_cast<float>(pixels_.x) / static_cast<float>(size_.x) : 1.0f;
  glm::vec2 scale(1.0f);
  glfwGetWindowContentScale(handle_, &scale.x, &scale.y);
  scale_ = std::clamp(scale.x / drawn, 0.5f, 4.0f);
  if (glfwGetWindowAttrib(handle_, GLFW_ICONIFIED) != GLFW_FALSE) pixels_ = glm::ivec2(0);
}

void Window::setSize(glm::ivec2 size) {
  glfwSetWindowSize(handle_, size.x, size.y);
}

void Window::setTitle(const std::string& title) {
  glfwSetWindowTitle(handle_, title.c_str());
}

void Window::setCursor(int shape) {
  if (shape == cursor_) return;
  cursor_ = shape;
  glfwSetInputMode(handle_, GLFW_CURSOR, shape < 0 ? GLFW_CURSOR_HIDDEN : GLFW_CURSOR_NORMAL);
  if (shape >= 0)
    glfwSetCursor(handle_, static_cast<size_t>(shape) < cursors_.size() ? cursors_[static_cast<size_t>(shape)]
                                                                        : cursors_.front());
}

void Window::minimise(bool minimised) {
  if (minimised)
    glfwIconifyWindow(handle_);
  else
    glfwRestoreWindow(handle_);
}

std::string Window::clipboard() const {
  const char* text = glfwGetClipboardString(handle_);
  return text == nullptr ? "" : text;
}

void Window::setClipboard(const std::string& text) {
  glfwSetClipboardString(handle_, text.c_str());
}

}  // namespace weir::view
