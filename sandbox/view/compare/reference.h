// What the shown picture is compared with: a graph whose mean grows in the background, or a picture from a file.
#pragma once

#include <weir/execute/executor.h>
#include <weir/image/image.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace weir::view {

/// A reference on the host.
struct ReferencePicture {
  image::Picture picture;  ///< radiance, alpha 1
  uint64_t view = 0;       ///< Reference::view() of what it shows
  uint64_t frames = 0;     ///< behind the mean; 0: of a file
  /// Its own expected relMSE, which adds to each that is measured against it: from how its frames vary, so they must be
  /// independent. Pixels that are not finite are left out. NaN: unknown.
  double relMse = 0.0;
  uint64_t nonFinite = 0;  ///< pixels
};

/// Everything here is for the window's thread.
class Reference {
 public:
  virtual ~Reference() = default;

  /// Something else is shown from now on: another camera, state of the scene, lights or size in pixels. What `shown`
  /// points to is copied. Throws what compiling and allocating throw; then the old one goes on.
  virtual void restart(const execute::FrameInput& shown, uint32_t width, uint32_t height) = 0;
  /// Once between two frames of the window: goes on for about so many milliseconds of the device's time and never keeps
  /// the caller longer than that. Returns how many frames it submitted. Throws RuntimeError (device lost, a pass that
  /// fails).
  virtual uint32_t step(double budgetMilliseconds) = 0;

  /// For commands that are submitted to the device's queue before the next call of anything here: an RGBA32F image in
  /// the layout GENERAL. Commands begin and end with barriers, as for Executor::locate. None before the first frame.
  virtual std::optional<execute::Executor::Located> image() const = 0;
  /// The newest on the host, a while behind image(); null before the first of this view().
  virtual std::shared_ptr<const ReferencePicture> latest() const = 0;

  /// Changes with every restart that changes what is shown: pictures are comparable to a ReferencePicture of the same
  /// one.
  virtual uint64_t view() const = 0;
  /// What it is and how good: one line.
  virtual std::string words() const = 0;
  /// What speaks against comparing with it, or empty.
  virtual std::string warning() const = 0;
};

/// "312 frames; its own relMSE is 1.3e-05: smaller errors can't be told"
std::string qualityInWords(const ReferencePicture& reference);

}  // namespace weir::view
