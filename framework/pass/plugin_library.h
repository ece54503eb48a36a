// One opened plugin library. What is opened is a private copy of the file, so that the file can be rebuilt while its
// old code still runs, and so that a rebuilt one is new to the dynamic linker.
#pragma once

#include <weir/pass/plugin.h>

#include <filesystem>
#include <memory>

namespace weir {

struct PluginManifest;

class PluginLibrary {
 public:
  /// Opens a copy of the manifest's library and compares its descriptor with host and manifest. Throws InputError that
  /// names plugin and library.
  static std::shared_ptr<const PluginLibrary> open(const PluginManifest& manifest);
  /// Unmaps the code. Whoever holds a pointer into the library holds the library.
  ~PluginLibrary();
  PluginLibrary(const PluginLibrary&) = delete;
  PluginLibrary& operator=(const PluginLibrary&) = delete;

  const WeirPluginDescriptor& descriptor() const { return *descriptor_; }
  /// Where the copy was when it was opened. Its folder is gone by now; debuggers and /proc/self/maps know it by this
  /// name.
  const std::filesystem::path& copy() const { return copy_; }

 private:
  PluginLibrary() = default;

  std::filesystem::path copy_;
  void* handle_ = nullptr;
  const WeirPluginDescriptor* descriptor_ = nullptr;
};

/// Throws InputError, beginning with `who`, unless the file is a complete shared library for this machine: opening a
/// half-written one would end the process rather than fail.
void checkSharedLibrary(const std::filesystem::path& file, const std::string& who);

/// Throws InputError, beginning with `who`, unless ABI version and build tag are this Weir's.
void compareBuild(const std::string& who, uint32_t abi, std::string_view buildTag);

}  // namespace weir
