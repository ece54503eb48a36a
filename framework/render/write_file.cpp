#include <fmt/format.h>
#include <unistd.h>
#include <weir/core/error.h>
#include <weir/image/atomic_file.h>
#include <weir/render/write_file.h>

#include <filesystem>

namespace weir::render {
namespace {

namespace fs = std::filesystem;

/// Where a path ends, whether or not there is a file yet.
fs::path placeOf(const std::string& path) {
  std::error_code failed;
  const fs::path place = fs::weakly_canonical(fs::absolute(path, failed), failed);
  return failed ? fs::path(path).lexically_normal() : place;
}

}  // namespace

void checkWritable(const std::string& path) {
  std::error_code ignored;
  fs::path target = path;
  // As AtomicFile: a link is followed, one that leads nowhere is replaced itself.
  if (fs::is_symlink(target, ignored)) {
    const fs::path real = fs::canonical(target, ignored);
    if (!ignored) target = real;
  }
  const fs::path folder = target.parent_path().empty() ? fs::path(".") : target.parent_path();
  if (!fs::is_directory(folder, ignored)) throw InputError("can't write " + path + ": no folder " + folder.string());
  if (fs::is_directory(target, ignored)) throw InputError("can't write " + path + ": that is a folder");
  if (fs::exists(target, ignored) && !fs::is_regular_file(target, ignored))
    throw InputError("can't write " + path + ": that is no regular file");
  if (access(folder.c_str(), W_OK) != 0)
    throw InputError("can't write " + path + ": no permission in " + folder.string());
}

void requireDistinct(const std::vector<NamedPath>& outputs, const std::vector<NamedPath>& inputs) {
  std::vector<std::pair<NamedPath, fs::path>> taken;
  for (const NamedPath& input : inputs) {
    if (!input.second.empty()) taken.emplace_back(input, placeOf(input.second));
  }
  const size_t read = taken.size();
  for (const NamedPath& output : outputs) {
    if (output.second.empty()) continue;
    const fs::path place = placeOf(output.second);
    for (size_t i = 0; i < taken.size(); ++i) {
      if (taken[i].second != place) continue;
      const NamedPath& other = taken[i].first;
      throw InputError(fmt::format("{} would write {}, which {} {}", output.first, output.second, other.first,
                                   i < read ? "reads" : "writes too"));
    }
    taken.emplace_back(output, place);
  }
}

void writeTextFile(const std::string& path, const std::string& text) {
  image::AtomicFile file(path);
  std::fwrite(text.data(), 1, text.size(), file.stream());
  file.commit();
}

}  // namespace weir::render
