#include <weir/core/error.h>
#include <weir/core/paths.h>
#include <weir/pass/plugin_loader.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <set>
#include <string_view>

namespace weir {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kManifestPrefix = "weir_";

}  // namespace

std::vector<fs::path> pluginSearchPath(const std::vector<std::string>& folders) {
  std::vector<fs::path> path(folders.begin(), folders.end());
  if (const char* variable = std::getenv("WEIR_PLUGIN_PATH")) {
    std::string_view rest = variable;
    while (!rest.empty()) {
      const std::string_view folder = rest.substr(0, rest.find(':'));
      if (!folder.empty()) path.emplace_back(folder);
      rest.remove_prefix(std::min(rest.size(), folder.size() + 1));
    }
  }
  if (fs::path own = resourceFolder(); !own.empty()) path.push_back(std::move(own));
  return path;
}

PluginLoader::PluginLoader(const std::vector<fs::path>& folders) {
  std::set<fs::path> seen;
  std::vector<PluginManifest> found;
  for (const fs::path& folder : folders) {
    std::error_code error;
    const fs::path real = fs::canonical(folder, error);
    if (error || !fs::is_directory(real, error))
      problems_.push_back({"", fmt::format("{}: on the plugin path, but no folder", folder.string()), {}});
    else if (seen.insert(real).second)
      readFolder(real, found);
  }
  std::map<std::string, std::vector<PluginManifest>> claims;
  for (PluginManifest& manifest : found) claims[manifest.name].push_back(std::move(manifest));
  for (auto& [name, claimants] : claims) {
    if (claimants.size() == 1) {
      manifests_[name] = std::move(claimants.front());
      continue;
    }
    std::string files;
    for (const PluginManifest& one : claimants) files += (files.empty() ? "" : " and ") + one.file.string();
    problems_.push_back({name,
                         fmt::format("{} plugins claim the name '{}': {}; none of them is used",
                                     claimants.size() == 2 ? "two" : "several", name, files),
                         {}});
  }
}

void PluginLoader::readFolder(const fs::path& folder, std::vector<PluginManifest>& found) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with(kManifestPrefix) && name.ends_with(".json")) files.push_back(entry->path());
  }
  if (error) problems_.push_back({"", fmt::format("{}: can't be listed: {}", folder.string(), error.message()), {}});
  std::sort(files.begin(), files.end());  // a folder has no order of its own
  for (const fs::path& file : files) {
    try {
      found.push_back(readManifest(file));
    } catch (const InputError& bad) {
      const std::string stem = file.stem().string();
      problems_.push_back({stem.substr(kManifestPrefix.size()), bad.what(), file});
    }
  }
}

}  // namespace weir
