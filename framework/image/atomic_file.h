// A file that appears whole or not at all: written under a temporary name beside its target, then renamed.
#pragma once

#include <cstdio>
#include <string>

namespace weir::image {

/// Opens a new file beside `path` (same folder, so that the rename cannot cross file systems). Until commit() the
/// target keeps its old content; an AtomicFile that is destroyed without commit() leaves nothing behind. A symbolic
/// link is followed; a target that exists and isn't a regular file is refused, as a rename would replace it.
class AtomicFile {
 public:
  /// Throws RuntimeError that names the path and the reason: no such folder, no permission, a folder, a device.
  explicit AtomicFile(const std::string& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  std::FILE* stream() { return stream_; }
  /// Flushes, closes and renames. Throws RuntimeError if any write until here failed (a full disk shows here at the
  /// latest).
  void commit();

 private:
  std::string path_, target_, temporary_;
  std::FILE* stream_ = nullptr;
};

}  // namespace weir::image
