#include <fmt/format.h>
#include <weir/shader/sources.h>

#include <filesystem>
#include <fstream>
#include <set>

namespace weir::shader {
namespace fs = std::filesystem;
namespace {

/// Reading a folder or a device as text would hang or give nonsense.
bool readText(const std::string& path, std::string& text) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return false;
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return false;
  text.resize(static_cast<size_t>(std::max<std::streamoff>(file.tellg(), 0)));
  file.seekg(0);
  return static_cast<bool>(file.read(text.data(), static_cast<std::streamsize>(text.size())));
}

std::string_view skipBlanks(std::string_view text) {
  const size_t at = text.find_first_not_of(" \t");
  return at == std::string_view::npos ? std::string_view() : text.substr(at);
}

bool hasPragmaOnce(std::string_view text) {
  for (size_t at = text.find('#'); at != std::string_view::npos; at = text.find('#', at + 1)) {
    std::string_view rest = skipBlanks(text.substr(at + 1));
    if (!rest.starts_with("pragma")) continue;
    rest = skipBlanks(rest.substr(6));
    if (rest.starts_with("once")) return true;
  }
  return false;
}

}  // namespace

std::string readFile(const std::string& path) {
  std::string text;
  if (!readText(path, text)) throw InputError(fmt::format("Cannot read {}.", path));
  return text;
}

Sources::Sources(const CompileRequest& request) : request_(request) {}

const Sources::File* Sources::read(const std::string& path) {
  const auto [entry, isNew] = files_.try_emplace(path);
  if (isNew) {
    auto file = std::make_unique<File>();
    file->path = path;
    if (readText(path, file->text)) {
      file->once = hasPragmaOnce(file->text);
      entry->second = std::move(file);
    }
  }
  return entry->second.get();
}

const Sources::File* Sources::resolve(std::string_view name, std::string_view includer, bool system) {
  if (const auto found = request_.virtualFiles.find(std::string(name)); found != request_.virtualFiles.end()) {
    std::unique_ptr<File>& file = files_[found->first];
    if (!file) {
      file = std::make_unique<File>(
          File{.path = found->first, .text = found->second, .isVirtual = true, .once = hasPragmaOnce(found->second)});
    }
    return file.get();
  }
  for (const std::string& path : places(name, includer, system)) {
    if (const File* file = read(path)) return file;
  }
  return nullptr;
}

std::vector<std::string> Sources::places(std::string_view name, std::string_view includer, bool system) const {
  if (fs::path(name).is_absolute()) return {fs::path(name).lexically_normal().string()};
  std::vector<std::string> paths;
  const auto add = [&](const fs::path& folder) { paths.push_back((folder / name).lexically_normal().string()); };
  // A name that only stands for a text ("test", a virtual file) has no folder of its own.
  if (!system && !request_.virtualFiles.contains(std::string(includer))) {
    const fs::path folder = fs::path(includer).parent_path();
    std::error_code error;
    if (!folder.empty() || fs::is_regular_file(fs::path(includer), error)) add(folder);
  }
  for (const std::string& folder : request_.includeFolders) add(folder);
  return paths;
}

std::vector<Sources::Include> Sources::scan(std::string_view text) {
  std::vector<Include> includes;
  for (size_t at = text.find('#'); at != std::string_view::npos; at = text.find('#', at + 1)) {
    std::string_view rest = skipBlanks(text.substr(at + 1));
    if (!rest.starts_with("include")) continue;
    rest = skipBlanks(rest.substr(7));
    if (rest.empty() || (rest[0] != '"' && rest[0] != '<')) continue;
    const bool system = rest[0] == '<';
    const size_t end = rest.find_first_of(system ? ">\n" : "\"\n", 1);
    if (end != std::string_view::npos && rest[end] != '\n') {
      includes.push_back({.name = std::string(rest.substr(1, end - 1)), .system = system});
    }
  }
  return includes;
}

void Sources::followAll() {
  struct Text {
    std::string_view text, path;
  };
  std::vector<Text> pending = {{request_.source, request_.name}};
  std::set<const File*> seen;
  while (!pending.empty()) {
    const Text current = pending.back();
    pending.pop_back();
    for (const Include& include : scan(current.text)) {
      const File* file = resolve(include.name, current.path, include.system);
      if (file && seen.insert(file).second) pending.push_back({file->text, file->path});
    }
  }
}

}  // namespace weir::shader
