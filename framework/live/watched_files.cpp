#include <weir/live/watched_files.h>

#include <sys/stat.h>
#include <time.h>

#include <utility>

namespace weir::live {

WatchedFiles::Seen WatchedFiles::look(const std::string& file) {
  struct stat status {};
  if (stat(file.c_str(), &status) != 0) return {};
  return {{status.st_mtim.tv_sec, status.st_mtim.tv_nsec}, static_cast<uint64_t>(status.st_size), status.st_ino};
}

WatchedFiles::Moment WatchedFiles::now() {
  timespec time{};
  clock_gettime(CLOCK_REALTIME, &time);  // files are dated by it, give or take a tick of the kernel
  return {time.tv_sec, time.tv_nsec};
}

void WatchedFiles::watch(const std::vector<std::string>& files, Moment before) {
  std::map<std::string, Seen> wanted;
  for (const std::string& file : files) {
    if (const auto known = files_.find(file); known != files_.end()) {
      wanted[file] = known->second;
      continue;
    }
    const Seen seen = look(file);
    wanted[file] = seen.written.isAfter(before) ? Seen{} : seen;
  }
  files_ = std::move(wanted);
}

std::vector<std::string> WatchedFiles::changed() {
  std::vector<std::string> result;
  for (auto& [file, seen] : files_) {
    const Seen now = look(file);
    if (now == seen) continue;
    seen = now;
    result.push_back(file);
  }
  return result;
}

}  // namespace weir::live
