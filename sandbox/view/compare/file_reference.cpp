#include "view/compare/file_reference.h"

#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/render/reference_picture.h>

#include <filesystem>
#include <limits>
#include <utility>

namespace weir::view {

namespace {

std::shared_ptr<const ReferencePicture> readReference(const std::string& file) {
  ReferencePicture reference;
  reference.picture = render::readRadiance(file);
  reference.view = 1;
  reference.relMse = std::numeric_limits<double>::quiet_NaN();
  return std::make_shared<const ReferencePicture>(std::move(reference));
}

}  // namespace

FileReference::FileReference(const gpu::Device& device, const std::string& file, const render::Stage& stage,
                             const std::string& animation, uint32_t width, uint32_t height)
    : device_(device),
      file_(file),
      picture_(readReference(file)),
      width_(width),
      height_(height),
      image_(device, picture_->picture, "reference") {
  try {
    render::requireSameSubject(stage, animation, file, picture_->picture);
  } catch (const InputError& error) {
    subject_ = error.what();
  }
}

FileReference::~FileReference() {
  device_.waitIdle();  // somebody may show its image still
}

void FileReference::restart(const execute::FrameInput& shown, uint32_t width, uint32_t height) {
  width_ = width;
  height_ = height;
  const scene::Camera& now = shown.camera;
  if (!camera_) {
    camera_ = now;
    return;
  }
  const bool sameCamera = now.eye == camera_->eye && now.forward == camera_->forward && now.up == camera_->up &&
                          now.verticalFov == camera_->verticalFov;
  // Of a scene that moves one moment can't be told from another here.
  moved_ = !sameCamera || shown.state != nullptr;
}

std::string FileReference::words() const {
  const image::Picture& picture = picture_->picture;
  return fmt::format("{}, {}x{}: {}", std::filesystem::path(file_).filename().string(), picture.width, picture.height,
                     qualityInWords(*picture_));
}

std::string FileReference::warning() const {
  std::string text = subject_;
  const auto add = [&](const std::string& line) { text += (text.empty() ? "" : "\n") + line; };
  const image::Picture& picture = picture_->picture;
  if (picture.width != width_ || picture.height != height_)
    add(fmt::format("'{}' is {}x{} pixels and {}x{} are shown: no error can be told", file_, picture.width,
                    picture.height, width_, height_));
  if (moved_) add("the camera or the scene has moved since the file was opened");
  return text;
}

}  // namespace weir::view
