// Every known pass type, from plugins and from the program itself. Plugins are loaded when a type of theirs is first
// asked for, and can be loaded anew. Not for use by several threads at once.
#pragma once

#include <weir/pass/pass_handle.h>
#include <weir/pass/plugin_loader.h>

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace weir {

namespace graph {
struct PassCatalog;
}

class Registry {
 public:
  /// Knows only what add() gives it.
  Registry() = default;
  /// Reads the manifests in these folders: see pluginSearchPath().
  explicit Registry(const std::vector<std::filesystem::path>& pluginFolders);
  Registry(const Registry&) = delete;
  Registry& operator=(const Registry&) = delete;

  /// Adds all of these passes as types "plugin.Name", or none: InputError when a pass or the plugin is there already,
  /// when a describe() throws or when a description contradicts itself.
  void add(const std::string& plugin, std::span<const WeirPassEntry> passes, std::filesystem::path shaders = {});

  /// The description of "plugin.Pass", loading its plugin if need be; nullptr when there is none (problem() says why).
  /// The description lives as long as the registry, also when reload() brings another one for that type.
  const PassDescription* find(const std::string& type);
  /// A new pass. InputError when the type can't be had; InputError or RuntimeError when its constructor fails.
  PassPtr create(const std::string& type);
  /// Why the type can't be had; empty when it can.
  std::string problem(const std::string& type);

  /// Reads the plugin's manifest again and opens its library anew, whether it was open, refused or not asked for yet.
  /// Descriptions and code asked for afterwards are the new ones; passes that were made before run their old code until
  /// they are destroyed, and the last one takes the old library with it. InputError when the new one is refused:
  /// everything is then as it was before.
  void reload(const std::string& plugin);
  /// What to watch for changes: the plugin's manifest, and its library if the manifest could be read. Empty for a
  /// plugin of the program itself and for an unknown one.
  std::vector<std::filesystem::path> pluginFiles(const std::string& plugin) const;

  /// Every type, sorted. Loads all plugins.
  std::vector<std::string> types();
  /// The folder with the shaders of the type's plugin; empty when it has none.
  std::filesystem::path shaderFolder(const std::string& type);
  /// Loads what is not loaded yet; what fails is in problems().
  void loadAll();
  /// Everything that is wrong with plugins so far.
  const std::vector<PluginProblem>& problems() const { return problems_; }

  /// For graph::compile; refers to this registry. Defined in graph/catalog.cpp.
  graph::PassCatalog catalog();

 private:
  /// The library is held here while its functions can be asked for, and by each pass that was made from it.
  struct Entry {
    std::unique_ptr<PassDescription> description;  ///< its address is handed out
    WeirPassEntry functions;
    std::string plugin;
    std::shared_ptr<const PluginLibrary> library;  ///< null: the program itself
  };
  using Entries = std::map<std::string, Entry>;

  static Entries describeAll(const std::string& plugin, std::span<const WeirPassEntry> passes,
                             const std::shared_ptr<const PluginLibrary>& library);
  static Entries open(const PluginManifest& manifest);
  const Entry* entry(const std::string& type);
  void load(const std::string& plugin);
  void retire(const std::string& plugin);

  std::map<std::string, PluginManifest> manifests_;       ///< of every plugin that has files, loaded or not
  std::map<std::string, PluginManifest> waiting_;         ///< plugins that nobody asked for yet
  std::map<std::string, std::filesystem::path> shaders_;  ///< of each plugin that is there
  Entries entries_;
  std::vector<std::unique_ptr<PassDescription>> retired_;  ///< replaced by reload(); their addresses are handed out
  std::vector<PluginProblem> problems_;
};

}  // namespace weir
