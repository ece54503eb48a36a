#include <dlfcn.h>
#include <weir/core/error.h>
#include <weir/core/paths.h>

#include <cstdlib>

namespace weir {

std::filesystem::path libraryFolder() {
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&libraryFolder), &info) == 0 || info.dli_fname == nullptr) return ".";
  std::error_code ignored;
  const std::filesystem::path file = std::filesystem::weakly_canonical(info.dli_fname, ignored);
  return ignored ? std::filesystem::path(info.dli_fname).parent_path() : file.parent_path();
}

std::filesystem::path resourceFolder() {
  const std::filesystem::path own = libraryFolder();
  std::error_code ignored;
  return std::filesystem::is_directory(own / "weir", ignored) ? own / "weir" : own;
}

std::filesystem::path commonShaderFolder() {
  const char* given = std::getenv("WEIR_SHADERS");
  std::filesystem::path folder =
      (given != nullptr && *given != '\0' ? std::filesystem::path(given) : resourceFolder() / "shaders") / "common";
  if (!std::filesystem::is_directory(folder)) {
    throw InputError("no shaders at " + folder.string() + " (WEIR_SHADERS names the folder that holds 'common')");
  }
  return folder;
}

}  // namespace weir
