#include <weir/core/error.h>
#include <weir/live/session.h>

#include <algorithm>
#include <exception>
#include <iterator>
#include <set>
#include <utility>

namespace weir::live {
namespace {

/// Runs what an edit asks for; what goes wrong is the event's error.
template <typename Work>
void attempt(Event& event, Work work) {
  try {
    work();
  } catch (const std::exception& error) {
    event.error += (event.error.empty() ? "" : "\n") + std::string(error.what());
  }
}

}  // namespace

Session::Session(const gpu::Device& device, shader::Compiler& compiler, Registry& registry,
                 const scene::SceneGpu& scene, const std::string& graphFile, const graph::Overrides& overrides,
                 const graph::CompileOptions& compileOptions, const execute::ExecutorOptions& executorOptions)
    : registry_(registry), graphFile_(graphFile), overrides_(overrides), options_(compileOptions) {
  executor_ = std::make_unique<execute::Executor>(device, compiler, registry, scene, compile(overrides, options_),
                                                  executorOptions);
  watch();
}

graph::CompiledGraph Session::compile(const graph::Overrides& overrides, const graph::CompileOptions& options) const {
  return graph::compileFile(graphFile_, overrides, registry_.catalog(), options);
}

/// Of the plugins that the running graph uses.
std::vector<std::string> Session::plugins() const {
  std::set<std::string> names;
  for (const graph::CompiledPass& pass : executor_->graph().passes)
    names.insert(pass.type.substr(0, pass.type.find('.')));
  return {names.begin(), names.end()};
}

void Session::watch() {
  std::vector<std::string> files = executor_->runtime().shaderFiles();
  files.push_back(graphFile_);
  for (const std::string& plugin : plugins())
    for (const auto& file : registry_.pluginFiles(plugin)) files.push_back(file.string());
  files_.watch(files);
}

void Session::change(const graph::Overrides& overrides, const graph::CompileOptions& compileOptions) {
  executor_->swap(compile(overrides, compileOptions));
  overrides_ = overrides;
  options_ = compileOptions;
  watch();
}

std::vector<Event> Session::poll() {
  std::vector<std::string> changed = files_.changed();
  if (changed.empty()) return {};
  std::vector<Event> events;
  const auto takeOut = [&changed](auto which) {
    std::vector<std::string> taken;
    std::copy_if(changed.begin(), changed.end(), std::back_inserter(taken), which);
    std::erase_if(changed, which);
    return taken;
  };

  // Plugins first: a graph may have been edited to use what is new in them.
  for (const std::string& plugin : plugins()) {
    const auto files = registry_.pluginFiles(plugin);
    Event event{Event::Kind::Plugin, takeOut([&](const std::string& file) {
                  return std::find(files.begin(), files.end(), file) != files.end();
                }),
                ""};
    if (event.files.empty()) continue;
    attempt(event, [&] {
      registry_.reload(plugin);
      executor_->swap(compile(overrides_, options_));
    });
    events.push_back(std::move(event));
  }
  Event graphEvent{Event::Kind::Graph, takeOut([&](const std::string& file) { return file == graphFile_; }), ""};
  if (!graphEvent.files.empty()) {
    attempt(graphEvent, [&] { executor_->swap(compile(overrides_, options_)); });
    events.push_back(std::move(graphEvent));
  }
  if (!changed.empty()) {
    Event event{Event::Kind::Shader, std::move(changed), ""};
    attempt(event, [&] { executor_->reloadShaders(); });
    events.push_back(std::move(event));
  }
  watch();
  return events;
}

}  // namespace weir::live
