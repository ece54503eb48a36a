// Finds plugins by their manifests; plugin_library.h opens them, one at a time and only when asked. Whatever is wrong
// with a plugin is a finding about that plugin; the host and the other plugins live on.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace weir {

/// weir_<name>.json, read before anything is loaded. Paths are absolute.
struct PluginManifest {
  std::string name;
  std::filesystem::path file, library, shaders;
  uint32_t abi = 0;
  std::string buildTag;
};

/// Throws InputError that names the file.
PluginManifest readManifest(const std::filesystem::path& file);

struct PluginProblem {
  std::string plugin;              ///< empty when it is about the search path
  std::string message;             ///< complete: names the file
  std::filesystem::path manifest;  ///< that can't be read; empty when it is about something else
};

/// Where plugins are looked for: `folders` (--plugin-path), WEIR_PLUGIN_PATH (colon separated), then
/// those that came with libweir.so, in resourceFolder().
std::vector<std::filesystem::path> pluginSearchPath(const std::vector<std::string>& folders);

class PluginLoader {
 public:
  /// Reads every manifest in `folders`; loads nothing.
  explicit PluginLoader(const std::vector<std::filesystem::path>& folders);

  /// Plugins that can be asked for, by name.
  const std::map<std::string, PluginManifest>& manifests() const { return manifests_; }
  /// What was wrong with manifests and folders.
  const std::vector<PluginProblem>& problems() const { return problems_; }

 private:
  void readFolder(const std::filesystem::path& folder, std::vector<PluginManifest>& found);

  std::map<std::string, PluginManifest> manifests_;
  std::vector<PluginProblem> problems_;
};

}  // namespace weir
