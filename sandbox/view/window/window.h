// The window itself: GLFW behind the app's own events. Only one may exist, on the main thread.
#pragma once

#include "view/input/event.h"

#include <weir/gpu/vulkan.h>

#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

struct GLFWwindow;
struct GLFWcursor;

namespace weir::view {

/// GLFW as long as there is a window. Throws RuntimeError where there is no display.
class WindowSystem {
 public:
  WindowSystem();
  ~WindowSystem();
  WindowSystem(const WindowSystem&) = delete;
  WindowSystem& operator=(const WindowSystem&) = delete;
  /// Of the Vulkan instance, for gpu::DeviceOptions. RuntimeError where windows and Vulkan don't go together.
  std::vector<std::string> vulkanExtensions() const;
};

class Window {
 public:
  /// `size` in window coordinates; smaller where the screen is.
  Window(const WindowSystem& system, const std::string& title, glm::ivec2 size);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Throws RuntimeError. The caller destroys it before the window.
  VkSurfaceKHR makeSurface(VkInstance instance) const;

  /// Looks for what has happened; waits for up to `seconds` where nothing has. The events come in takeEvents().
  void poll(double seconds = 0.0);
  std::vector<Event> takeEvents();

  // As of the last poll(): each would ask the window system and wait for its answer.
  glm::ivec2 size() const { return size_; }               ///< window coordinates
  glm::ivec2 framebufferSize() const { return pixels_; }  ///< 0 while minimised
  float contentScale() const { return scale_; }           ///< of the display that it is on
  void setSize(glm::ivec2 size);
  void setTitle(const std::string& title);
  /// ImGui's number of the shape (ImGuiMouseCursor_); below 0: none.
  void setCursor(int shape);
  void minimise(bool minimised);
  std::string clipboard() const;
  void setClipboard(const std::string& text);

 private:
  static Window& of(GLFWwindow* handle);
  void listen();
  void look();

  GLFWwindow* handle_ = nullptr;
  std::vector<Event> events_;
  std::vector<GLFWcursor*> cursors_;
  int cursor_ = -2;
  glm::ivec2 size_{0}, pixels_{0};
  float scale_ = 1.0f;
};

}  // namespace weir::view
