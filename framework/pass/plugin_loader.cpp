#include <weir/core/error.h>
#include <weir/core/paths.h>
#include <weir/pass/plugin_loader.h>

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <set>
#include <string_view>

namespace weir {
namespace {

namespace fs = std::filesystem;

void compareBuild(const std::string& who, uint32_t abi, std::string_view buildTag) {
  if (abi != WEIR_ABI_VERSION)
    throw InputError(fmt::format("{} is built for plugin ABI {}, this Weir has ABI {}; rebuild the plugin", who, abi,
                                 WEIR_ABI_VERSION));
  if (buildTag != WEIR_BUILD_TAG)
    throw InputError(
        fmt::format("{} has build tag '{}', this Weir has '{}'; rebuild the plugin", who, buildTag, WEIR_BUILD_TAG));
}

std::string lastLinkError() {
  const char* error = dlerror();
  return error ? error : "unknown reason";
}

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
  if (fs::path own = libraryFolder(); !own.empty()) path.push_back(std::move(own));
  return path;
}

PluginLoader::PluginLoader(const std::vector<fs::path>& folders) {
  std::set<fs::path> seen;
  std::vector<PluginManifest> found;
  for (const fs::path& folder : folders) {
    std::error_code error;
    const fs::path real = fs::canonical(folder, error);
    if (error || !fs::is_directory(real, error))
      problems_.push_back({"", fmt::format("{}: on the plugin path, but no folder", folder.string())});
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
    problems_.push_back({name, fmt::format("{} plugins claim the name '{}': {}; none of them is used",
                                           claimants.size() == 2 ? "two" : "several", name, files)});
  }
}

void PluginLoader::readFolder(const fs::path& folder, std::vector<PluginManifest>& found) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with("weir_") && name.ends_with(".json")) files.push_back(entry->path());
  }
  if (error) problems_.push_back({"", fmt::format("{}: can't be listed: {}", folder.string(), error.message())});
  std::sort(files.begin(), files.end());  // a folder has no order of its own
  for (const fs::path& file : files) {
    try {
      found.push_back(readManifest(file));
    } catch (const InputError& bad) {
      const std::string stem = file.stem().string();
      problems_.push_back({stem.substr(std::string_view("weir_").size()), bad.what()});
    }
  }
}

const WeirPluginDescriptor& PluginLoader::open(const PluginManifest& manifest) {
  const std::string who = fmt::format("plugin '{}' ({})", manifest.name, manifest.library.string());
  compareBuild(fmt::format("plugin '{}' (manifest {})", manifest.name, manifest.file.string()), manifest.abi,
               manifest.buildTag);
  std::error_code error;
  if (!fs::exists(manifest.library, error))
    throw InputError(fmt::format("{}: the library named by {} does not exist", who, manifest.file.string()));
  void* library = dlopen(manifest.library.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) throw InputError(fmt::format("{} can't be loaded: {}", who, lastLinkError()));

  void* symbol = dlsym(library, "weir_plugin");
  if (!symbol) throw InputError(fmt::format("{} does not export the function weir_plugin", who));
  const WeirPluginDescriptor* descriptor = nullptr;
  try {
    descriptor = reinterpret_cast<WeirPluginFunction>(symbol)();
  } catch (const std::exception& thrown) {
    throw InputError(fmt::format("{}: weir_plugin threw: {}", who, thrown.what()));
  } catch (...) {
    throw InputError(fmt::format("{}: weir_plugin threw something that is no exception", who));
  }
  if (!descriptor) throw InputError(fmt::format("{}: weir_plugin returned nothing", who));
  compareBuild(who, descriptor->abiVersion, descriptor->buildTag ? descriptor->buildTag : "");
  if (!descriptor->name || manifest.name != descriptor->name)
    throw InputError(fmt::format("{} calls itself '{}'; its manifest {} says '{}'", who,
                                 descriptor->name ? descriptor->name : "", manifest.file.string(), manifest.name));
  if (descriptor->passCount > 0 && !descriptor->passes)
    throw InputError(fmt::format("{} announces {} passes and lists none", who, descriptor->passCount));
  return *descriptor;
}

}  // namespace weir
