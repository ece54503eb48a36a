// Notices that files changed: by looking at them, as that works for every editor, on every file system.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace weir::live {

class WatchedFiles {
 public:
  /// Watches these and no others. Those that were watched before keep what was seen of them, so that a change in
  /// between is not lost.
  void watch(const std::vector<std::string>& files);
  /// What changed since the last call: written, replaced, removed or there again. Sorted.
  std::vector<std::string> changed();

 private:
  /// All zero: there is no such file.
  struct Seen {
    int64_t seconds = 0, nanoseconds = 0;
    uint64_t size = 0, inode = 0;
    bool operator==(const Seen&) const = default;
  };
  static Seen look(const std::string& file);
  std::map<std::string, Seen> files_;
};

}  // namespace weir::live
