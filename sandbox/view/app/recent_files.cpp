#include "view/app/recent_files.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <utility>

namespace weir::view {
namespace {

namespace fs = std::filesystem;

std::string usualFile() {
  if (const char* state = std::getenv("XDG_STATE_HOME"); state != nullptr && *state != '\0')
    return std::string(state) + "/weir/recent";
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
    return std::string(home) + "/.local/state/weir/recent";
  return {};
}

}  // namespace

RecentFiles::RecentFiles(std::string file) : file_(file.empty() ? usualFile() : std::move(file)) {
  std::ifstream stream(file_);
  for (std::string line; paths_.size() < kMost && std::getline(stream, line);)
    if (!line.empty()) paths_.push_back(line);
}

void RecentFiles::add(const std::string& path) {
  std::error_code error;
  const fs::path absolute = fs::absolute(path, error);
  const std::string whole = error ? path : absolute.lexically_normal().string();
  if (whole.find('\n') != std::string::npos) return;
  std::erase(paths_, whole);
  paths_.insert(paths_.begin(), whole);
  if (paths_.size() > kMost) paths_.resize(kMost);
  if (file_.empty()) return;
  fs::create_directories(fs::path(file_).parent_path(), error);
  // Two windows at once: the last one to write wins, and no file is ever half-written.
  const std::string temporary = file_ + ".new";
  {
    std::ofstream out(temporary, std::ios::trunc);
    for (const std::string& each : paths_) out << each << '\n';
    if (!out.flush()) return;
  }
  fs::rename(temporary, file_, error);
}

}  // namespace weir::view
