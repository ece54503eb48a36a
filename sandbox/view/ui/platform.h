// Dear ImGui's context, fed with the app's own events: it knows no window system, so that tests and scripts drive it
// exactly as a user does.
#pragma once

#include "view/input/event.h"

#include <deque>
#include <functional>
#include <memory>
#include <string>

struct ImGuiContext;

namespace weir::view {

/// The system's clipboard; either may be empty.
struct Clipboard {
  std::function<std::string()> get;
  std::function<void(const std::string&)> set;
};

class UiPlatform {
 public:
  /// One at a time in a process. `scale` as in Ui.
  UiPlatform(float scale, Clipboard clipboard);
  ~UiPlatform();
  UiPlatform(const UiPlatform&) = delete;
  UiPlatform& operator=(const UiPlatform&) = delete;

  /// For the next frame. A button that goes down and up again within a frame is seen down in one and up in the next.
  void feed(const Event& event);
  /// Begins ImGui's frame. `windowSize` in window coordinates, `pixelsPerUnit` of the framebuffer.
  void beginFrame(glm::vec2 windowSize, glm::vec2 pixelsPerUnit, double seconds);

  /// Whether the user is busy with a widget rather than with the picture, as of the last frame.
  bool wantsMouse() const;
  bool wantsKeyboard() const;
  bool editsText() const;

  /// Fonts and spaces for another display; the renderer's font texture must be made anew.
  void setScale(float scale);

 private:
  struct ContextDeleter {
    void operator()(ImGuiContext* context) const;
  };
  bool apply(const Event& event);
  static const char* getClipboard(void* self);
  static void setClipboard(void* self, const char* text);

  std::unique_ptr<ImGuiContext, ContextDeleter> context_;
  Clipboard clipboard_;
  std::string clipboardText_;
  std::deque<Event> waiting_;
  unsigned pressed_ = 0;  ///< buttons that changed in this frame, a mask
};

}  // namespace weir::view
