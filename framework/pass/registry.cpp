#include <weir/core/error.h>
#include <weir/core/text.h>
#include <weir/pass/registry.h>

#include <fmt/format.h>

#include <utility>

namespace weir {
namespace {

std::string pluginOf(const std::string& type) {
  return type.substr(0, type.find('.'));
}

std::unique_ptr<PassDescription> describePass(const std::string& plugin, const WeirPassEntry& pass) {
  if (!pass.name || !*pass.name || !pass.describe || !pass.create || !pass.destroy)
    throw InputError(fmt::format("plugin '{}': a pass lacks its name or one of its functions", plugin));
  auto description = std::make_unique<PassDescription>();
  const std::string type = plugin + "." + pass.name;
  try {
    pass.describe(*description);
  } catch (const std::exception& thrown) {
    throw InputError(fmt::format("pass '{}': describe() threw: {}", type, thrown.what()));
  } catch (...) {
    throw InputError(fmt::format("pass '{}': describe() threw something that is no exception", type));
  }
  description->type = type;
  description->check();
  return description;
}

}  // namespace

Registry::Registry(const std::vector<std::filesystem::path>& pluginFolders) {
  const PluginLoader loader(pluginFolders);
  waiting_ = loader.manifests();
  problems_ = loader.problems();
}

void Registry::add(const std::string& plugin, std::span<const WeirPassEntry> passes, std::filesystem::path shaders) {
  if (plugin.empty() || plugin.find('.') != std::string::npos)
    throw InputError(fmt::format("'{}' can't be the name of a plugin", plugin));
  if (shaders_.count(plugin) || waiting_.count(plugin))
    throw InputError(fmt::format("there is a plugin '{}' already", plugin));
  std::map<std::string, Entry> added;
  for (const WeirPassEntry& pass : passes) {
    std::unique_ptr<PassDescription> description = describePass(plugin, pass);
    const std::string type = description->type;
    if (!added.try_emplace(type, Entry{std::move(description), pass, plugin}).second)
      throw InputError(fmt::format("plugin '{}' has two passes called '{}'", plugin, pass.name));
  }
  entries_.merge(added);
  shaders_[plugin] = std::move(shaders);
}

void Registry::load(const std::string& plugin) {
  const auto found = waiting_.find(plugin);
  if (found == waiting_.end()) return;
  const PluginManifest manifest = std::move(found->second);
  waiting_.erase(found);  // once: a plugin that was refused stays refused
  try {
    const WeirPluginDescriptor& descriptor = PluginLoader::open(manifest);
    add(plugin, {descriptor.passes, descriptor.passCount}, manifest.shaders);
  } catch (const InputError& bad) {
    const std::string file = manifest.library.string(), message = bad.what();
    const bool placed =
        message.find(file) != std::string::npos || message.find(manifest.file.string()) != std::string::npos;
    problems_.push_back({plugin, placed ? message : fmt::format("plugin '{}' ({}): {}", plugin, file, message)});
  }
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
  Pass* pass = nullptr;
  try {
    pass = found->functions.create();
  } catch (const std::exception& thrown) {
    throw RuntimeError(fmt::format("pass '{}' can't be made: {}", type, thrown.what()));
  } catch (...) {
    throw RuntimeError(fmt::format("pass '{}' can't be made: it threw something that is no exception", type));
  }
  if (!pass) throw RuntimeError(fmt::format("pass '{}' can't be made: its plugin returned nothing", type));
  return PassPtr(pass, PassDeleter{found->functions.destroy});
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
