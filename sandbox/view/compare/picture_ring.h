// Pictures from the device to the host without anybody waiting: a few buffers in turn, each lent out with what the
// device wrote into it. Whoever has one makes floats of it, on a thread of its own.
#pragma once

#include <weir/execute/executor.h>
#include <weir/gpu/memory.h>
#include <weir/image/image.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace weir::view {

/// What the device wrote. Copies share it; the last one gives it back to its ring, which it may outlive, but the device
/// not.
class HostCopy {
 public:
  uint64_t number() const { return number_; }  ///< as capture() was told
  uint32_t width() const { return width_; }
  uint32_t height() const { return height_; }
  /// As floats; one channel becomes grey, what is missing 0 and alpha 1, as Executor::read. On any thread.
  image::Picture picture() const;

 private:
  friend class PictureRing;
  HostCopy() = default;
  std::shared_ptr<const gpu::Buffer> bytes_;
  Format format_ = Format::RGBA32F;
  uint32_t width_ = 0, height_ = 0;
  uint64_t number_ = 0;
};

class PictureRing {
 public:
  /// At most `most` copies are on their way or lent out at a time. The device must outlive the ring and its copies.
  explicit PictureRing(const gpu::Device& device, size_t most = 3);
  /// Waits for copies that are on their way.
  ~PictureRing();
  PictureRing(const PictureRing&) = delete;
  PictureRing& operator=(const PictureRing&) = delete;

  /// Submits a copy of an image as it is after everything submitted so far. False, and nothing happens, while all
  /// buffers are on their way or lent out. Throws InputError for what is no image, RuntimeError.
  bool capture(const execute::Executor::Located& image, uint64_t number);
  /// The copies that are done, oldest first. Never waits.
  std::vector<HostCopy> take();
  /// Whether one is on its way.
  bool pending() const;

 private:
  struct Slot;
  Slot* freeSlot();

  const gpu::Device& device_;
  size_t most_;
  std::vector<std::unique_ptr<Slot>> slots_;
  uint64_t captured_ = 0;
};

}  // namespace weir::view
