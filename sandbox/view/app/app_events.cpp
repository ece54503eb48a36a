// What events do: to the picture, the camera and the keys' commands. ImGui gets them all as well.
#include "view/app/app.h"
#include "view/app/app_guard.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

namespace weir::view {
namespace {

constexpr float kTurn = 0.0045f;  // radians a unit of the mouse

}  // namespace

bool App::overPicture(glm::vec2 at) const {
  return layout_.picture.contains(at) && !platform_->wantsMouse();
}

glm::vec2 App::toCanvas(glm::vec2 at) const {
  return at * (glm::vec2(window_.framebufferSize()) / glm::max(glm::vec2(window_.size()), 1.0f));
}

void App::handle(const Event& event) {
  switch (event.kind) {
    case Event::Kind::Drop:
      handleDrop(event.files);
      break;
    case Event::Kind::Close:
      requests_.push_back(Quit{});
      break;
    case Event::Kind::Key:
      handleKey(event);
      break;
    case Event::Kind::Focus:
      if (!event.down) keys_.clear();
      break;
    case Event::Kind::Text:
      if (event.character == U'.' && !platform_->editsText()) requests_.push_back(StepFrame{});
      break;
    default:
      handleMouse(event);
      break;
  }
  platform_->feed(event);
}

void App::handleMouse(const Event& event) {
  if (event.kind == Event::Kind::MouseLeave) mouse_ = glm::vec2(-1.0f);
  if (event.kind == Event::Kind::MouseMove) {
    const glm::vec2 by = event.position - mouse_;
    mouse_ = event.position;
    const float height = std::max(layout_.picture.size().y, 1.0f);
    switch (drag_) {
      case Drag::Orbit:
        camera_->orbit({by.x * -kTurn, by.y * kTurn});
        break;
      case Drag::Look:
        camera_->look({by.x * kTurn, -by.y * kTurn});
        break;
      case Drag::Pan:
        camera_->pan(by / height);
        break;
      case Drag::Move:
        picture_->move(toCanvas(by));
        break;
      case Drag::Split:
        picture_->splitAt =
            std::clamp((mouse_.x - layout_.picture.low.x) / std::max(layout_.picture.size().x, 1.0f), 0.0f, 1.0f);
        break;
      case Drag::None:
        break;
    }
  }
  if (event.kind == Event::Kind::MouseButton) {
    held_ = event.modifiers;
    if (!event.down) {
      drag_ = Drag::None;
      return;
    }
    if (!overPicture(mouse_)) return;
    const float line = layout_.picture.low.x + picture_->splitAt * layout_.picture.size().x;
    const bool onLine = picture_->split && picture_->beside() && std::abs(mouse_.x - line) < 6.0f * scale_;
    if (event.modifiers.alt && event.button == MouseButton::Left) {
      const std::optional<PixelPlace> at = picture_->pixelAt(toCanvas(mouse_));
      pinned_ = pinned_ ? std::nullopt : at;
    } else if (onLine && event.button == MouseButton::Left) {
      drag_ = Drag::Split;
    } else if (event.modifiers.control) {
      drag_ = Drag::Move;
    } else if (event.button == MouseButton::Right) {
      drag_ = Drag::Look;
    } else {
      drag_ = event.button == MouseButton::Middle || event.modifiers.shift ? Drag::Pan : Drag::Orbit;
    }
  }
  if (event.kind == Event::Kind::Scroll && overPicture(mouse_)) {
    if (held_.control)
      picture_->zoomAbout(toCanvas(mouse_), std::pow(1.25f, event.position.y));
    else if (drag_ == Drag::Look)
      camera_->setSpeed(camera_->speed() * std::pow(1.2f, event.position.y));
    else
      camera_->approach(event.position.y);
  }
}

void App::handleKey(const Event& event) {
  held_ = event.modifiers;
  if (!event.down) {
    keys_.erase(event.key);
    return;
  }
  if (platform_->editsText()) return;
  keys_.insert(event.key);
  // Keys move widgets' focus as well; that of the window's commands do not.
  handleShortcut(event);
}

void App::handleShortcut(const Event& event) {
  const bool control = event.modifiers.control, shift = event.modifiers.shift;
  const auto want = [&](Request request) { requests_.push_back(std::move(request)); };
  const std::string folder = std::filesystem::path(document_.file()).parent_path().string();
  const auto ask = [&](FileDialog::For what, const std::string& start) {
    guard("file", [&] { files_.open(what, start); });
  };
  if (event.key >= Key::Digit1 && event.key <= Key::Digit9 && !control) {
    want(ChooseCamera{static_cast<int>(event.key) - static_cast<int>(Key::Digit1)});
    return;
  }
  switch (event.key) {
    case Key::F1:
      help_ = !help_;
      break;
    case Key::F2:
      layoutState_.graph = !layoutState_.graph;
      break;
    case Key::F3:
      layoutState_.side = !layoutState_.side;
      break;
    case Key::F4:
      layoutState_.times = !layoutState_.times;
      break;
    case Key::F5:
      followFiles(true);
      break;
    case Key::Tab:
      if (!platform_->wantsKeyboard()) layoutState_.all = !layoutState_.all;
      break;
    case Key::Escape:
      help_ = false;
      layoutState_.all = true;
      break;
    case Key::Space:
      if (!platform_->wantsKeyboard()) want(SetPaused{!engine_->paused()});
      break;
    case Key::R:
      if (!control) want(Restart{});
      break;
    case Key::F:
      if (!control) want(ChooseCamera{-1});
      break;
    case Key::C:
      if (control)
        want(CopyCommand{});
      else
        picture_->split = !picture_->split && picture_->beside();
      break;
    case Key::O:
      if (control)
        ask(shift ? FileDialog::For::OpenScene : FileDialog::For::OpenGraph,
            shift ? engine_->stageOptions().scene : document_.file());
      break;
    case Key::S:
      if (control && shift) ask(FileDialog::For::SaveGraph, document_.file());
      if (control && !shift) want(SaveGraph{});
      break;
    case Key::P:
      if (control) ask(FileDialog::For::SaveShot, "picture.png");
      break;
    case Key::Z:
      if (control && shift) edits_.emplace_back(Redo{});
      if (control && !shift) edits_.emplace_back(Undo{});
      break;
    case Key::Q:
      if (control) want(Quit{});
      break;
    default:
      break;
  }
}

/// W A S D, Q E while the right button looks around.
void App::fly(double seconds) {
  if (drag_ != Drag::Look) return;
  const auto axis = [this](Key plus, Key minus) {
    return (keys_.contains(plus) ? 1.0f : 0.0f) - (keys_.contains(minus) ? 1.0f : 0.0f);
  };
  const glm::vec3 direction(axis(Key::D, Key::A), axis(Key::E, Key::Q), axis(Key::W, Key::S));
  if (direction == glm::vec3(0.0f)) return;
  const float fast = held_.shift ? 4.0f : 1.0f;
  camera_->fly(direction * fast, static_cast<float>(std::min(seconds, 0.25)));
}

void App::handleDrop(const std::vector<std::string>& files) {
  for (const std::string& file : files) {
    std::string extension = std::filesystem::path(file).extension().string();
    std::ranges::transform(extension, extension.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (extension == ".json")
      requests_.push_back(OpenGraph{file});
    else if (extension == ".gltf" || extension == ".glb")
      requests_.push_back(OpenScene{file});
    else if (extension == ".exr")
      requests_.push_back(OpenSecond{file});
    else
      messages_.add(
          Severity::Error, "file",
          file + ": is neither a scene (.gltf, .glb) nor a graph (.json) nor a picture to compare with (.exr)");
  }
}

}  // namespace weir::view
