#include <weir/core/error.h>
#include <weir/live/session.h>

#include <algorithm>
#include <exception>
#include <iterator>
#include <set>
#include <utility>

namespace weir::live {
namespace {

std::string pluginOf(const std::string& type) {
  return type.substr(0, type.find('.'));
}

/// Runs what an edit asks for. What goes wrong is the event's error; whether nothing did.
template <typename Work>
bool attempt(Event& event, Work work) {
  try {
    work();
    return true;
  } catch (const std::exception& error) {
    event.error += (event.error.empty() ? "" : "\n") + std::string(error.what());
    return false;
  }
}

}  // namespace

Session::Session(const gpu::Device& device, shader::Compiler& compiler, Registry& registry,
                 const scene::SceneGpu& scene, const std::string& graphFile, const graph::Overrides& overrides,
                 const graph::CompileOptions& compileOptions, const execute::ExecutorOptions& executorOptions)
    : registry_(registry), graphFile_(graphFile), overrides_(overrides), options_(compileOptions) {
  const WatchedFiles::Moment before = WatchedFiles::now();
  executor_ = std::make_unique<execute::Executor>(device, compiler, registry, scene, compile(overrides, options_),
                                                  executorOptions);
  watch(before);
}

Session::Session(const gpu::Device& device, shader::Compiler& compiler, Registry& registry,
                 const scene::SceneGpu& scene, const std::string& graphFile, const std::string& json,
                 const graph::CompileOptions& compileOptions, const execute::ExecutorOptions& executorOptions)
    : registry_(registry), graphFile_(graphFile), json_(json), options_(compileOptions) {
  const WatchedFiles::Moment before = WatchedFiles::now();
  executor_ = std::make_unique<execute::Executor>(device, compiler, registry, scene, compile(overrides_, options_),
                                                  executorOptions);
  watch(before);
}

graph::CompiledGraph Session::compile(const graph::Overrides& overrides, const graph::CompileOptions& options) const {
  if (json_) return graph::compileText(*json_, graphFile_, overrides, registry_.catalog(), options);
  return graph::compileFile(graphFile_, overrides, registry_.catalog(), options);
}

/// Of all passes that the graph names, as far as it can be read.
std::vector<std::string> Session::typesNamed() const {
  std::vector<std::string> types;
  try {
    std::vector<graph::Diagnostic> ignored;
    const graph::Description description =
        json_ ? graph::parse(*json_, graphFile_, ignored) : graph::load(graphFile_, ignored);
    for (const graph::PassEntry& pass : description.passes) types.push_back(pass.type);
  } catch (const InputError&) {
    // Unreadable at the moment.
  }
  return types;
}

/// Of the passes that run or ran, and of those that the file names: what is wrong with a plugin may be why it does not
/// run yet.
const std::set<std::string>& Session::plugins() {
  std::set<std::string>& names = plugins_;
  for (const graph::CompiledPass& pass : executor_->graph().passes) names.insert(pluginOf(pass.type));
  for (const std::string& type : typesNamed()) names.insert(pluginOf(type));
  return names;
}

std::vector<std::string> Session::filesOf(const std::string& plugin) const {
  std::vector<std::string> files;
  for (const auto& file : registry_.pluginFiles(plugin)) files.push_back(file.string());
  if (files.empty()) return files;
  try {
    // The library that the manifest names by now, also when it is not there yet.
    files.push_back(readManifest(files.front()).library.string());
  } catch (const InputError&) {
    // The manifest itself is watched.
  }
  return files;
}

void Session::watch(WatchedFiles::Moment before) {
  const std::set<std::string>& shaders = executor_->shaderFiles();
  std::vector<std::string> files(shaders.begin(), shaders.end());
  files.push_back(graphFile_);
  for (const std::string& plugin : plugins())
    for (std::string& file : filesOf(plugin)) files.push_back(std::move(file));
  files_.watch(files, before);
}

void Session::change(const graph::Overrides& overrides, const graph::CompileOptions& compileOptions) {
  const WatchedFiles::Moment before = WatchedFiles::now();
  executor_->swap(compile(overrides, compileOptions));
  overrides_ = overrides;
  options_ = compileOptions;
  watch(before);
}

void Session::edit(const std::string& json, const graph::CompileOptions& compileOptions) {
  std::optional<std::string> before = std::exchange(json_, json);
  try {
    change(overrides_, compileOptions);
  } catch (...) {
    json_ = std::move(before);
    throw;
  }
}

std::vector<Event> Session::poll() {
  const WatchedFiles::Moment before = WatchedFiles::now();
  std::vector<std::string> changed = files_.changed();
  if (changed.empty()) return {};
  std::vector<Event> events;
  const auto takeOut = [&changed](auto which) {
    std::vector<std::string> taken;
    std::copy_if(changed.begin(), changed.end(), std::back_inserter(taken), which);
    std::erase_if(changed, which);
    return taken;
  };

  // All plugins, then one graph: what one of them shares with another fits only when both are new.
  for (const std::string& plugin : plugins()) {
    const std::vector<std::string> files = filesOf(plugin);
    Event event{Event::Kind::Plugin, takeOut([&](const std::string& file) {
                  return std::find(files.begin(), files.end(), file) != files.end();
                }),
                ""};
    if (event.files.empty()) continue;
    attempt(event, [&] { registry_.reload(plugin); });
    events.push_back(std::move(event));
  }
  std::vector<std::string> graphFiles = takeOut([&](const std::string& file) { return file == graphFile_; });
  if (!graphFiles.empty()) events.push_back({Event::Kind::Graph, std::move(graphFiles), ""});
  if (!changed.empty()) {
    shadersPending_ = true;
    events.push_back({Event::Kind::Shader, std::move(changed), ""});
  }

  // Whatever changed, what comes of it is the graph as its file now says it. What is wrong with that is told by each of
  // the changes that were fine until then.
  Event outcome;
  attempt(outcome, [&] {
    graph::CompiledGraph graph = compile(overrides_, options_);
    if (shadersPending_)
      executor_->restart(std::move(graph));
    else
      executor_->swap(std::move(graph));
    shadersPending_ = false;
  });
  for (Event& event : events)
    if (event.error.empty()) event.error = outcome.error;
  watch(before);
  return events;
}

}  // namespace weir::live
