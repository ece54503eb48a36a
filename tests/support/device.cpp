#include "device.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <mutex>
#include <stdexcept>

namespace weir::test {
namespace fs = std::filesystem;

std::string deviceChoice() {
  const char* wanted = std::getenv("WEIR_TEST_DEVICE");
  return wanted && *wanted ? wanted : "cpu";
}

bool validationWanted() {
  const char* wanted = std::getenv("WEIR_TEST_VALIDATION");
  return wanted == nullptr || std::string(wanted) != "off";
}

namespace {

std::string within(const char* variable, const char* compiledIn, const std::string& relative) {
  const char* given = std::getenv(variable);
  return std::string(given != nullptr && *given != 0 ? given : compiledIn) + "/" + relative;
}

}  // namespace

std::string sourcePath(const std::string& relative) {
  return within("WEIR_SOURCE_DIR", WEIR_SOURCE_DIR, relative);
}

std::string binaryPath(const std::string& relative) {
  return within("WEIR_BINARY_DIR", WEIR_BINARY_DIR, relative);
}

std::shared_ptr<gpu::Device> validatedDevice() {
  // Held here until the program ends: making a device takes longer than most tests. GoogleTest tears environments down
  // before static objects die, and the validation layer must not outlive its own statics.
  struct Holder final : ::testing::Environment {
    std::shared_ptr<gpu::Device> device;
    void TearDown() override { device.reset(); }
  };
  static std::once_flag once;
  static Holder* holder = nullptr;  // owned by GoogleTest
  std::call_once(once, [] {
    holder = new Holder;
    ::testing::AddGlobalTestEnvironment(holder);
  });
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  if (!holder->device) {
    holder->device = std::make_shared<gpu::Device>(
        gpu::DeviceOptions{.choice = deviceChoice(), .validation = validationWanted(), .cacheFolder = "-"});
  }
  return holder->device;
}

ExpectNoValidationMessages::ExpectNoValidationMessages(gpu::Device& device) : device_(device) {
  device_.clearValidationMessages();
}

ExpectNoValidationMessages::~ExpectNoValidationMessages() {
  for (const gpu::ValidationMessage& message : device_.validationMessages()) {
    ADD_FAILURE() << (message.error ? "validation error " : "validation warning ") << message.id << ": "
                  << message.text;
  }
  device_.clearValidationMessages();
}

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (fs::temp_directory_path() / "weir-test-XXXXXX").string();
  if (!mkdtemp(pattern.data())) throw std::runtime_error("cannot make a temporary folder");
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code error;
  fs::remove_all(path_, error);
}

std::string TemporaryFolder::write(const std::string& name, const std::string& text) const {
  const fs::path path = fs::path(path_) / name;
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << text;
  return path.string();
}

}  // namespace weir::test
