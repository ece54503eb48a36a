#include "view/ui/platform.h"

#include "view/ui/style.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace weir::view {

void UiPlatform::ContextDeleter::operator()(ImGuiContext* context) const {
  ImGui::DestroyContext(context);
}

UiPlatform::UiPlatform(float scale, Clipboard clipboard)
    : context_(ImGui::CreateContext()), clipboard_(std::move(clipboard)) {
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;  // places of panels are the app's own business
  io.BackendPlatformName = "weir";
  io.ConfigWindowsMoveFromTitleBarOnly = true;
  io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
  const auto map = [&io](ImGuiKey_ key, Key ours) { io.KeyMap[key] = static_cast<int>(ours); };
  map(ImGuiKey_Tab, Key::Tab);
  map(ImGuiKey_LeftArrow, Key::Left);
  map(ImGuiKey_RightArrow, Key::Right);
  map(ImGuiKey_UpArrow, Key::Up);
  map(ImGuiKey_DownArrow, Key::Down);
  map(ImGuiKey_PageUp, Key::PageUp);
  map(ImGuiKey_PageDown, Key::PageDown);
  map(ImGuiKey_Home, Key::Home);
  map(ImGuiKey_End, Key::End);
  map(ImGuiKey_Insert, Key::Insert);
  map(ImGuiKey_Delete, Key::Delete);
  map(ImGuiKey_Backspace, Key::Backspace);
  map(ImGuiKey_Space, Key::Space);
  map(ImGuiKey_Enter, Key::Enter);
  map(ImGuiKey_Escape, Key::Escape);
  map(ImGuiKey_A, Key::A);
  map(ImGuiKey_C, Key::C);
  map(ImGuiKey_V, Key::V);
  map(ImGuiKey_X, Key::X);
  map(ImGuiKey_Y, Key::Y);
  map(ImGuiKey_Z, Key::Z);
  io.ClipboardUserData = this;
  io.GetClipboardTextFn = &UiPlatform::getClipboard;
  io.SetClipboardTextFn = &UiPlatform::setClipboard;
  setScale(scale);
}

UiPlatform::~UiPlatform() = default;

void UiPlatform::setScale(float scale) {
  applyStyle(scale);
}

const char* UiPlatform::getClipboard(void* self) {
  auto& platform = *static_cast<UiPlatform*>(self);
  if (platform.clipboard_.get) platform.clipboardText_ = platform.clipboard_.get();
  return platform.clipboardText_.c_str();
}

void UiPlatform::setClipboard(void* self, const char* text) {
  auto& platform = *static_cast<UiPlatform*>(self);
  platform.clipboardText_ = text;
  if (platform.clipboard_.set) platform.clipboard_.set(platform.clipboardText_);
}

void UiPlatform::feed(const Event& event) {
  waiting_.push_back(event);
}

/// False when the event has to wait for the next frame.
bool UiPlatform::apply(const Event& event) {
  ImGuiIO& io = ImGui::GetIO();
  const auto modifiers = [&io](const Modifiers& held) {
    io.KeyCtrl = held.control;
    io.KeyShift = held.shift;
    io.KeyAlt = held.alt;
  };
  switch (event.kind) {
    case Event::Kind::MouseMove:
      if (pressed_ != 0) return false;  // a click is where the button went down
      io.MousePos = {event.position.x, event.position.y};
      break;
    case Event::Kind::MouseLeave:
      io.MousePos = {-std::numeric_limits<float>::max(), -std::numeric_limits<float>::max()};
      break;
    case Event::Kind::MouseButton: {
      const auto button = static_cast<unsigned>(event.button);
      if ((pressed_ & (1u << button)) != 0) return false;
      pressed_ |= 1u << button;
      io.MouseDown[button] = event.down;
      modifiers(event.modifiers);
      break;
    }
    case Event::Kind::Scroll:
      io.MouseWheelH += event.position.x;
      io.MouseWheel += event.position.y;
      break;
    case Event::Kind::Key:
      io.KeysDown[static_cast<size_t>(event.key)] = event.down;
      modifiers(event.modifiers);
      break;
    case Event::Kind::Text:
      io.AddInputCharacter(event.character);
      break;
    case Event::Kind::Focus:
      io.AddFocusEvent(event.down);
      if (!event.down) std::fill(std::begin(io.KeysDown), std::end(io.KeysDown), false);
      break;
    case Event::Kind::Drop:
    case Event::Kind::Close:
      break;
  }
  return true;
}

void UiPlatform::beginFrame(glm::vec2 windowSize, glm::vec2 pixelsPerUnit, double seconds) {
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = {windowSize.x, windowSize.y};
  io.DisplayFramebufferScale = {pixelsPerUnit.x, pixelsPerUnit.y};
  io.DeltaTime = static_cast<float>(std::max(seconds, 1e-5));
  pressed_ = 0;
  while (!waiting_.empty() && apply(waiting_.front())) waiting_.pop_front();
  ImGui::NewFrame();
}

bool UiPlatform::wantsMouse() const {
  return ImGui::GetIO().WantCaptureMouse;
}

bool UiPlatform::wantsKeyboard() const {
  return ImGui::GetIO().WantCaptureKeyboard;
}

bool UiPlatform::editsText() const {
  return ImGui::GetIO().WantTextInput;
}

}  // namespace weir::view
