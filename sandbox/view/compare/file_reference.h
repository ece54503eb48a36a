// A picture from a file as the reference.
#pragma once

#include <weir/render/stage.h>

#include <memory>
#include <string>

#include "view/compare/reference.h"
#include "view/picture/uploaded_picture.h"

namespace weir::view {

class FileReference final : public Reference {
 public:
  /// Reads and uploads; `width` and `height` of what is shown. A header that names another scene, camera, lights,
  /// shading or moment (`animation`: as in pictures' headers), or another size, is a warning. Throws InputError: no EXR
  /// or HDR that can be read, a PNG, pixels that are not finite, larger than an image of the device can be.
  FileReference(const gpu::Device& device, const std::string& file, const render::Stage& stage,
                const std::string& animation, uint32_t width, uint32_t height);
  ~FileReference() override;
  FileReference(const FileReference&) = delete;
  FileReference& operator=(const FileReference&) = delete;

  /// The picture stays what it is; a size that is not its own is a warning, and so is another camera or state of the
  /// scene than at the first call.
  void restart(const execute::FrameInput& shown, uint32_t width, uint32_t height) override;
  uint32_t step(double /*budgetMilliseconds*/) override { return 0; }
  std::optional<execute::Executor::Located> image() const override { return {{&image_.storage(), &image_.resource()}}; }
  std::shared_ptr<const ReferencePicture> latest() const override { return picture_; }
  uint64_t view() const override { return picture_->view; }
  std::string words() const override;
  std::string warning() const override;

 private:
  const gpu::Device& device_;
  std::string file_, subject_;  ///< subject: what it shows that is not shown here
  std::shared_ptr<const ReferencePicture> picture_;
  uint32_t width_, height_;              ///< of what is shown
  std::optional<scene::Camera> camera_;  ///< at the first restart
  bool moved_ = false;
  UploadedPicture image_;
};

}  // namespace weir::view
