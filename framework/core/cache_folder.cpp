#include <fmt/format.h>
#include <unistd.h>
#include <weir/core/cache_folder.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace weir {
namespace fs = std::filesystem;

std::string cacheFolder(const std::string& wanted) {
  if (wanted == "-") return {};
  if (!wanted.empty()) return wanted;
  const auto variable = [](const char* name) -> std::string {
    const char* value = std::getenv(name);
    return value ? value : "";
  };
  if (const std::string own = variable("WEIR_CACHE_DIR"); !own.empty()) return own == "-" ? std::string() : own;
  if (const std::string xdg = variable("XDG_CACHE_HOME"); !xdg.empty()) return xdg + "/weir";
  if (const std::string home = variable("HOME"); !home.empty()) return home + "/.cache/weir";
  return {};
}

std::vector<char> readCacheFile(const std::string& path, size_t limit) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return {};
  const std::streamoff size = file.tellg();
  if (size <= 0 || static_cast<size_t>(size) > limit) return {};
  std::vector<char> bytes(static_cast<size_t>(size));
  file.seekg(0);
  if (!file.read(bytes.data(), size)) return {};
  return bytes;
}

bool writeCacheFile(const std::string& path, std::span<const char> bytes) noexcept try {
  static std::atomic<unsigned> serial{0};  // threads of one process write under different names
  const std::string temporary = fmt::format("{}.{}-{}.tmp", path, getpid(), serial++);
  std::error_code error;
  fs::create_directories(fs::path(path).parent_path(), error);
  bool written = false;
  {
    std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    written = static_cast<bool>(file);
  }
  if (written) fs::rename(temporary, path, error);
  if (!written || error) {
    fs::remove(temporary, error);
    return false;
  }
  return true;
} catch (...) {
  return false;
}

}  // namespace weir
