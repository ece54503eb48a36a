// Where things are kept that can be made again: compiled shaders, pipeline caches.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace weir {

/// The folder that `wanted` means: itself; for an empty one $WEIR_CACHE_DIR, else $XDG_CACHE_HOME/weir, else
/// ~/.cache/weir. Empty when there shall be no cache ("-") or none can be placed. The folder need not exist yet.
std::string cacheFolder(const std::string& wanted);

/// The whole file, or nothing when it can't be read or is above `limit` bytes. Never throws: a cache may be missing.
std::vector<char> readCacheFile(const std::string& path, size_t limit = size_t{256} << 20);

/// Writes beside the goal and renames, so that readers and other processes see the old file or the whole new one.
/// Makes the folder. False, leaving nothing behind, when that fails: a cache that can't be written is no error.
bool writeCacheFile(const std::string& path, std::span<const char> bytes) noexcept;

}  // namespace weir
