#include <weir/core/error.h>
#include <weir/core/text.h>
#include <weir/pass/plugin_errors.h>
#include <weir/pass/registry.h>

#include <fmt/format.h>

#include <utility>

namespace weir {
namespace {

std::string pluginOf(const std::string& type) {
  return type.substr(0, type.find('.'));
}

std::unique_ptr<PassDescription> describePass(const std::string& plugin, const WeirPassEntry& pass) {
  if (pass.name == nullptr || *pass.name == '\0' || pass.describe == nullptr || pass.create == nullptr ||
      pass.destroy == nullptr || pass.prepare == nullptr || pass.record == nullptr)
    throw InputError(fmt::format("plugin '{}': a pass lacks its name or one of its functions", plugin));
  auto description = std::make_unique<PassDescription>();
  const std::string type = plugin + "." + pass.name;
  PluginErrors errors;
  pass.describe(*description, errors.sink());
  if (errors.kind() != WEIR_ERROR_NONE)
    throw InputError(fmt::format("pass '{}': describe() threw: {}", type, errors.text()));
  description->type = type;
  description->check();
  return description;
}

}  // namespace

Registry::Registry(const std::vector<std::filesystem::path>& pluginFolders) {
  const PluginLoader loader(pluginFolders);
  waiting_ = manifests_ = loader.manifests();
  problems_ = loader.problems();
  for (const PluginProblem& problem : problems_) {
    // A manifest that can't be read is known by its file's name, so that reload() can read it again.
    if (problem.manifest.empty() || manifests_.count(problem.plugin) != 0) continue;
    manifests_[problem.plugin].file = problem.manifest;
  }
}

Registry::Entries Registry::describeAll(const std::string& plugin, std::span<const WeirPassEntry> passes,
                                        const std::shared_ptr<const PluginLibrary>& library) {
  Entries added;
  for (const WeirPassEntry& pass : passes) {
    std::unique_ptr<PassDescription> description = describePass(plugin, pass);
    const std::string type = description->type;
    if (!added.try_emplace(type, Entry{std::move(description), pass, plugin, library}).second)
      throw InputError(fmt::format("plugin '{}' has two passes called '{}'", plugin, pass.name));
  }
  return added;
}

/// Opens and describes; the error names the file.
Registry::Entries Registry::open(const PluginManifest& manifest) {
  try {
    const std::shared_ptr<const PluginLibrary> library = PluginLibrary::open(manifest);
    const WeirPluginDescriptor& descriptor = library->descriptor();
    return describeAll(manifest.name, {descriptor.passes, descriptor.passCount}, library);
  } catch (const InputError& bad) {
    const std::string file = manifest.library.string(), message = bad.what();
    const bool placed =
        message.find(file) != std::string::npos || message.find(manifest.file.string()) != std::string::npos;
    if (placed) throw;
    throw InputError(fmt::format("plugin '{}' ({}): {}", manifest.name, file, message));
  }
}

void Registry::add(const std::string& plugin, std::span<const WeirPassEntry> passes, std::filesystem::path shaders) {
  if (plugin.empty() || plugin.find('.') != std::string::npos)
    throw InputError(fmt::format("'{}' can't be the name of a plugin", plugin));
  if (shaders_.count(plugin) != 0 || manifests_.count(plugin) != 0)
    throw InputError(fmt::format("there is a plugin '{}' already", plugin));
  entries_.merge(describeAll(plugin, passes, nullptr));
  shaders_[plugin] = std::move(shaders);
}

void Registry::load(const std::string& plugin) {
  const auto found = waiting_.find(plugin);
  if (found == waiting_.end()) return;
  const PluginManifest manifest = std::move(found->second);
  waiting_.erase(found);  // once: a plugin that was refused stays refused until reload()
  try {
    entries_.merge(open(manifest));
    shaders_[plugin] = manifest.shaders;
  } catch (const InputError& bad) {
    problems_.push_back({plugin, bad.what(), {}});
  }
}

/// Forgets the plugin's passes, but keeps their descriptions.
void Registry::retire(const std::string& plugin) {
  for (auto entry = entries_.begin(); entry != entries_.end();) {
    if (entry->second.plugin == plugin) {
      retired_.push_back(std::move(entry->second.description));
      entry = entries_.erase(entry);
    } else {
      ++entry;
    }
  }
  std::erase_if(problems_, [&](const PluginProblem& problem) { return problem.plugin == plugin; });
  waiting_.erase(plugin);
}

void Registry::reload(const std::string& plugin) {
  const auto known = manifests_.find(plugin);
  if (known == manifests_.end()) {
    throw InputError(shaders_.count(plugin) != 0
                         ? fmt::format("plugin '{}' is part of the program and can't be loaded anew", plugin)
                         : problem(plugin + "."));
  }
  PluginManifest manifest = readManifest(known->second.file);
  if (manifest.name != plugin)
    throw InputError(
        fmt::format("{} is the manifest of '{}' now, not of '{}'", manifest.file.string(), manifest.name, plugin));
  Entries entries = open(manifest);
  retire(plugin);
  entries_.merge(entries);
  shaders_[plugin] = manifest.shaders;
  known->second = std::move(manifest);
}

std::vector<std::filesystem::path> Registry::pluginFiles(const std::string& plugin) const {
  const auto known = manifests_.find(plugin);
  if (known == manifests_.end()) return {};
  std::vector<std::filesystem::path> files{known->second.file};
  if (!known->second.library.empty()) files.push_back(known->second.library);
  return files;
}

void Registry::loadAll() {
  while (!waiting_.empty()) load(std::string(waiting_.begin()->first));
}

const Registry::Entry* Registry::entry(const std::string& type) {
  auto found = entries_.find(type);
  if (found == entries_.end()) {
    load(pluginOf(type));
    found = entries_.find(type);
  }
  return found == entries_.end() ? nullptr : &found->second;
}

const PassDescription* Registry::find(const std::string& type) {
  const Entry* found = entry(type);
  return found ? found->description.get() : nullptr;
}

std::string Registry::problem(const std::string& type) {
  if (entry(type)) return {};
  const std::string plugin = pluginOf(type);
  if (type.find('.') == std::string::npos) return fmt::format("'{}' is not of the form \"plugin.Pass\"", type);
  if (shaders_.count(plugin))
    return fmt::format("plugin '{}' has no pass '{}'", plugin, type.substr(plugin.size() + 1));
  for (const PluginProblem& problem : problems_)
    if (problem.plugin == plugin) return problem.message;
  return fmt::format("there is no plugin '{}' on the plugin path", plugin);
}

PassPtr Registry::create(const std::string& type) {
  const Entry* found = entry(type);
  if (!found) {
    const std::string nearest = nearestName(type, types());
    throw InputError(fmt::format("unknown pass type '{}': {}{}", type, problem(type),
                                 nearest.empty() ? "" : fmt::format(" (nearest: '{}')", nearest)));
  }
  return std::make_unique<PassHandle>(found->library, found->functions, type);
}

std::vector<std::string> Registry::types() {
  loadAll();
  std::vector<std::string> names;
  for (const auto& [type, unused] : entries_) names.push_back(type);
  return names;
}

std::filesystem::path Registry::shaderFolder(const std::string& type) {
  const Entry* found = entry(type);
  return found ? shaders_.at(found->plugin) : std::filesystem::path();
}

}  // namespace weir
