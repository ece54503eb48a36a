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
  if (fs::exists(path) && !fs::is_regular_file(path))
    throw InputError("can't write " + path + ": that is no regular file");
  if (access(folder.c_str(), W_OK) != 0)
    throw InputError("can't write " + path + ": no permission in " + folder.string());
}

void checkDistinct(const std::vector<NamedPath>& outputs, const std::vector<NamedPath>& inputs) {
  const auto same = [](const std::string& a, const std::string& b) {
    std::error_code failed;
    const std::filesystem::path x = std::filesystem::weakly_canonical(a, failed);
    if (failed) return a == b;
    const std::filesystem::path y = std::filesystem::weakly_canonical(b, failed);
    return failed ? a == b : x == y;
  };
  for (size_t i = 0; i < outputs.size(); ++i) {
    const auto& [option, path] = outputs[i];
    if (path.empty()) continue;
    for (size_t j = 0; j < i; ++j) {
      if (!outputs[j].second.empty() && same(path, outputs[j].second))
        throw InputError(outputs[j].first + " and " + option + " are one file: " + path);
    }
    for (const auto& [name, input] : inputs) {
      if (!input.empty() && same(path, input))
        throw InputError(option + " " + path + " would overwrite " + name + ", which is read");
    }
  }
}

void writeTextFile(const std::string& path, const std::string& text) {
  image::AtomicFile file(path);
  std::fwrite(text.data(), 1, text.size(), file.stream());
  file.commit();
}

}  // namespace weir::render
