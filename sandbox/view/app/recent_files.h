// Scenes and graphs that were opened lately, kept from one session to the next.
#pragma once

#include <string>
#include <vector>

namespace weir::view {

class RecentFiles {
 public:
  /// `file` keeps them; empty: $XDG_STATE_HOME/weir/recent, else ~/.local/state/weir/recent. What can't be read is
  /// taken for empty.
  explicit RecentFiles(std::string file = {});
  /// To the front; written at once, and not written where that is not possible.
  void add(const std::string& path);
  const std::vector<std::string>& all() const { return paths_; }

 private:
  static constexpr size_t kMost = 16;
  std::string file_;
  std::vector<std::string> paths_;
};

}  // namespace weir::view
