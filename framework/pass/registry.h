// Every known pass type, from plugins and from the program itself. Plugins are loaded when a type of theirs is first
// asked for. Not for use by several threads at once.
#pragma once

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

/// Frees a pass by the library that made it.
struct PassDeleter {
  void (*destroy)(Pass*) = nullptr;
  void operator()(Pass* pass) const { destroy(pass); }
};
using PassPtr = std::unique_ptr<Pass, PassDeleter>;

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
  /// The description lives as long as the registry.
  const PassDescription* find(const std::string& type);
  /// A new pass. InputError when the type can't be had; RuntimeError when its constructor fails.
  PassPtr create(const std::string& type);
  /// Why the type can't be had; empty when it can.
  std::string problem(const std::string& type);

  /// Every type, sorted. Loads all plugins.
  std::vector<std::string> types();
  /// The folder with the shaders of the type's plugin; empty when it has none.
  std::filesystem::path shaderFolder(const std::string& type);
  /// Loads what is not loaded yet; what fails is in problems().
  void loadAll();
  /// Everything that was wrong with plugins so far.
  const std::vector<PluginProblem>& problems() const { return problems_; }

  /// For graph::compile; refers to this registry. Defined in graph/catalog.cpp.
  graph::PassCatalog catalog();

 private:
  struct Entry {
    std::unique_ptr<PassDescription> description;  ///< its address is handed out
    WeirPassEntry functions;
    std::string plugin;
  };

  const Entry* entry(const std::string& type);
  void load(const std::string& plugin);

  std::map<std::string, PluginManifest> waiting_;         ///< plugins that nobody asked for yet
  std::map<std::string, std::filesystem::path> shaders_;  ///< of each plugin that is there
  std::map<std::string, Entry> entries_;
  std::vector<PluginProblem> problems_;
};

}  // namespace weir
