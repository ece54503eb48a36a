#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <weir/core/error.h>
#include <weir/image/atomic_file.h>

#include <cerrno>
#include <filesystem>
#include <random>
#include <system_error>

namespace weir::image {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, const std::string& reason) {
  throw RuntimeError(fmt::format("cannot write '{}': {}", path, reason));
}

std::string systemReason(int error) {
  return std::generic_category().message(error);
}

}  // namespace

AtomicFile::AtomicFile(const std::string& path) : path_(path), target_(path) {
  if (path.empty()) fail(path, "the name is empty");
  std::error_code ignored;
  if (fs::is_symlink(path, ignored)) {
    // canonical() fails on a dangling link; then the link itself is replaced, which is the best that is left.
    const fs::path real = fs::canonical(path, ignored);
    if (!ignored) target_ = real.string();
  }
  const fs::path folder = fs::path(target_).parent_path();
  if (!folder.empty() && !fs::exists(folder, ignored)) {
    fail(path, fmt::format("the folder '{}' does not exist", folder.string()));
  }
  if (fs::is_directory(target_, ignored)) fail(path, "it is a folder");
  if (fs::exists(target_, ignored) && !fs::is_regular_file(target_, ignored)) fail(path, "it is not a regular file");

  std::random_device random;
  int descriptor = -1, error = 0;
  for (int attempt = 0; attempt < 16 && descriptor < 0; ++attempt) {
    temporary_ = fmt::format("{}.{:08x}.tmp", target_, random());
    descriptor = ::open(temporary_.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0666);
    error = errno;
    if (descriptor < 0 && error != EEXIST) break;
  }
  if (descriptor < 0) fail(path, systemReason(error));
  stream_ = ::fdopen(descriptor, "w+b");
  if (!stream_) {
    error = errno;
    ::close(descriptor);
    ::unlink(temporary_.c_str());
    fail(path, systemReason(error));
  }
}

AtomicFile::~AtomicFile() {
  if (stream_) std::fclose(stream_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void AtomicFile::commit() {
  errno = 0;
  bool good = std::fflush(stream_) == 0;
  int error = errno;
  good = good && std::ferror(stream_) == 0;
  const bool closed = std::fclose(stream_) == 0;
  if (good && !closed) error = errno;
  stream_ = nullptr;
  if (!good || !closed) fail(path_, error != 0 ? systemReason(error) : "not everything could be written (disk full?)");
  if (std::rename(temporary_.c_str(), target_.c_str()) != 0) fail(path_, systemReason(errno));
  temporary_.clear();
}

}  // namespace weir::image
