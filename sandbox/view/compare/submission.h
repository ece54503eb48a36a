// A command buffer that is submitted to the device's queue beside the frames, and whether the device is done with it.
#pragma once

#include <weir/gpu/device.h>

#include <chrono>

namespace weir::view {

class Submission {
 public:
  /// The device must outlive it.
  explicit Submission(const gpu::Device& device, const char* name);
  /// Waits for what was submitted.
  ~Submission();
  Submission(const Submission&) = delete;
  Submission& operator=(const Submission&) = delete;

  /// An empty command buffer to record into. What was submitted before must be done.
  VkCommandBuffer begin();
  /// Submits what was recorded since begin(). Throws RuntimeError (device lost, …); then nothing is in flight.
  void submit();
  /// Submitted and not seen to be done.
  bool busy() const { return busy_; }
  /// Whether the device is done with it; never waits. True when nothing was submitted.
  bool done();
  /// The same, and waits for it as long as that at most.
  bool done(std::chrono::nanoseconds atMost);

 private:
  void destroy() noexcept;

  const gpu::Device& device_;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  VkFence fence_ = VK_NULL_HANDLE;
  bool busy_ = false;
};

}  // namespace weir::view
