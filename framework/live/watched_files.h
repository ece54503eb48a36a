// Notices that files changed: by looking at them, as that works for every editor, on every file system.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace weir::live {

class WatchedFiles {
 public:
  /// A point in time, by the clock that files are dated with.
  struct Moment {
    int64_t seconds = 0, nanoseconds = 0;
    bool operator==(const Moment&) const = default;
    bool isAfter(const Moment& other) const {
      return seconds != other.seconds ? seconds > other.seconds : nanoseconds > other.nanoseconds;
    }
  };
  static Moment now();

  /// Watches these and no others. Those that were watched before keep what was seen of them; of the others a change
  /// counts that was made after `before`, when their reading began.
  void watch(const std::vector<std::string>& files, Moment before);
  /// What changed since the last call: written, replaced, removed or there again. Sorted.
  std::vector<std::string> changed();

 private:
  /// All zero: there is no such file.
  struct Seen {
    Moment written;
    uint64_t size = 0, inode = 0;
    bool operator==(const Seen&) const = default;
  };
  static Seen look(const std::string& file);
  std::map<std::string, Seen> files_;
};

}  // namespace weir::live
