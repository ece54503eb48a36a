// Finds plugins by their manifests and opens their libraries, one at a time and only when asked. Whatever is wrong with
// a plugin is a finding about that plugin; the host and the other plugins live on.
#pragma once

#include <weir/pass/plugin.h>

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
  std::string plugin;   ///< empty when it is about the search path
  std::string message;  ///< complete: names the file
};

/// Where plugins are looked for: `folders` (--plugin-path), WEIR_PLUGIN_PATH (colon separated), the folder of
/// libweir.so.
std::vector<std::filesystem::path> pluginSearchPath(const std::vector<std::string>& folders);

class PluginLoader {
 public:
  /// Reads every manifest in `folders`; loads nothing.
  explicit PluginLoader(const std::vector<std::filesystem::path>& folders);

  /// Plugins that can be asked for, by name.
  const std::map<std::string, PluginManifest>& manifests() const { return manifests_; }
  /// What was wrong with manifests and folders.
  const std::vector<PluginProblem>& problems() const { return problems_; }

  /// Opens the library and compares its descriptor. Throws InputError saying what is wrong. A library is never closed:
  /// descriptions point into it.
  static const WeirPluginDescriptor& open(const PluginManifest& manifest);

 private:
  void readFolder(const std::filesystem::path& folder, std::vector<PluginManifest>& found);

  std::map<std::string, PluginManifest> manifests_;
  std::vector<PluginProblem> problems_;
};

}  // namespace weir
