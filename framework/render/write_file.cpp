#include <unistd.h>
#include <weir/core/error.h>
#include <weir/render/write_file.h>

#include <filesystem>
#include <fstream>

namespace weir::render {

void checkWritable(const std::string& path) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(path).parent_path().empty() ? fs::path(".") : fs::path(path).parent_path();
  if (!fs::is_directory(folder)) throw InputError("can't write " + path + ": no folder " + folder.string());
  if (fs::is_directory(path)) throw InputError("can't write " + path + ": that is a folder");
  if (access(folder.c_str(), W_OK) != 0) throw InputError("can't write " + path + ": no permission in " + folder.string());
}

void writeTextFile(const std::string& path, const std::string& text) {
  const std::string temporary = path + ".tmp" + std::to_string(getpid());
  {
    std::ofstream file(temporary, std::ios::binary);
    file << text;
    file.flush();
    if (!file) {
      std::filesystem::remove(temporary);
      throw RuntimeError("can't write " + path);
    }
  }
  std::error_code error;
  std::filesystem::rename(temporary, path, error);
  if (error) {
    std::filesystem::remove(temporary);
    throw RuntimeError("can't write " + path + ": " + error.message());
  }
}

}  // namespace weir::render
