// The device that tests run on, and the guard that no validation message passes unseen.
#pragma once

#include <weir/gpu/device.h>

#include <memory>
#include <string>

namespace weir::test {

/// What tests run on: $WEIR_TEST_DEVICE, or "cpu" so that they run everywhere and alike.
std::string deviceChoice();

/// Whether devices of tests get the validation layers: unless $WEIR_TEST_VALIDATION is "off", which is for machines
/// that have no layers.
bool validationWanted();

/// Absolute path of a file in the source tree, which $WEIR_SOURCE_DIR moves; and in the build tree ($WEIR_BINARY_DIR):
/// so test programs can be run from copies of both on another machine.
std::string sourcePath(const std::string& relative);
std::string binaryPath(const std::string& relative);

/// One device for the whole test program, with validation on. It lives until the last user lets go of it.
/// Hold the pointer in the test or the fixture for as long as anything made from it lives.
std::shared_ptr<gpu::Device> validatedDevice();

/// Fails the test with the messages' text when the validation layer has anything to say between construction and
/// destruction. Declare it after the device and before everything that is made from it.
struct ExpectNoValidationMessages {
  explicit ExpectNoValidationMessages(gpu::Device& device);
  ~ExpectNoValidationMessages();
  ExpectNoValidationMessages(const ExpectNoValidationMessages&) = delete;
  ExpectNoValidationMessages& operator=(const ExpectNoValidationMessages&) = delete;

 private:
  gpu::Device& device_;
};

/// A fresh folder that goes away with this object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::string& path() const { return path_; }
  /// Writes a file (and the folders it lies in) and returns its path.
  std::string write(const std::string& name, const std::string& text) const;

 private:
  std::string path_;
};

}  // namespace weir::test
