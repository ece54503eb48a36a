#include <unistd.h>
#include <weir/core/error.h>
#include <weir/image/atomic_file.h>
#include <weir/render/write_file.h>

#include <filesystem>

namespace weir::render {

void checkWritable(const std::string& path) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(path).parent_path().empty() ? fs::path(".") : fs::path(path).parent_path();
  if (!fs::is_directory(folder)) throw InputError("can't write " + path + ": no folder " + folder.string());
  if (fs::is_directory(path)) throw InputError("can't write " + path + ": that is a folder");
  if (access(folder.c_str(), W_OK) != 0)
    throw InputError("can't write " + path + ": no permission in " + folder.string());
}

void writeTextFile(const std::string& path, const std::string& text) {
  image::AtomicFile file(path);
  std::fwrite(text.data(), 1, text.size(), file.stream());
  file.commit();
}

}  // namespace weir::render
