// Graphs on a host's device: making one, and changing it while its frames are in flight.
#include <weir/core/text.h>
#include <weir/embed/call.h>

#include <algorithm>

namespace weir::embed {

GraphSource graphSource(const WeirGraphInfo& info) {
  if ((info.file == nullptr) == (info.json == nullptr))
    throw InputError("WeirGraphInfo needs a file or a JSON text, and not both");
  GraphSource s;
  s.file = info.file == nullptr ? "WeirGraphInfo.json" : info.file;
  s.json = info.file == nullptr ? info.json : shader::readFile(info.file);
  s.overrides = {texts(info.set, "WeirGraphInfo.set"), texts(info.enable, "WeirGraphInfo.enable"),
                 texts(info.disable, "WeirGraphInfo.disable")};
  s.options.width = info.width;
  s.options.height = info.height;
  s.options.provided = texts(info.provided, "WeirGraphInfo.provided");
  s.options.external = texts(info.external, "WeirGraphInfo.external");
  s.trace = text(info.trace);
  return s;
}

graph::CompiledGraph compile(Weir& weir, const GraphSource& source) {
  return graph::compileText(source.json, source.file, source.overrides, weir.registry.catalog(), source.options);
}

namespace {

/// A later value of a parameter replaces the earlier one, so that values set every frame don't pile up.
void addSet(std::vector<std::string>& all, const std::string& text) {
  const std::string key = text.substr(0, text.find('=') + 1);
  if (!key.empty()) std::erase_if(all, [&](const std::string& other) { return other.starts_with(key); });
  all.push_back(text);
}

void checkSize(uint32_t width, uint32_t height) {
  constexpr uint32_t kMost = 16384;  // as `weir render`
  if (width == 0 || height == 0 || width > kMost || height > kMost)
    throw InputError(fmt::format("a frame of {}x{}: each side must be 1 to {}", width, height, kMost));
}

}  // namespace
}  // namespace weir::embed

using namespace weir;
using namespace weir::embed;

WeirGraph::WeirGraph(WeirScene& owner, GraphSource from, trace::Backend backend)
    : scene(owner), source(std::move(from)), frame(scene.context.device, scene.context.weir.compiler, scene.gpu) {
  options.backend = backend;
  options.sceneFolder = scene.folder;
  runtime = std::make_unique<execute::GraphRuntime>(scene.context.services(), frame, compile(weir(), source), options);
  ++scene.children;
}

void WeirGraph::change(GraphSource next) {
  checkSize(next.options.width, next.options.height);
  graph::CompiledGraph compiled = compile(weir(), next);
  if (runtime->update(compiled)) {
    source = std::move(next);
    return;
  }
  const bool resized = compiled.width != runtime->graph().width || compiled.height != runtime->graph().height;
  auto made = std::make_unique<execute::GraphRuntime>(scene.context.services(), frame, std::move(compiled), options,
                                                      runtime.get());
  retired.reserve(retired.size() + 1);  // nothing may fail from here on: frames in flight use the old one
  std::swap(runtime, made);
  if (recorded != 0) retired.push_back({std::move(made), recorded});
  recorded = 0;
  replaced = true;
  source = std::move(next);
  if (resized) frame.forget();
  // What fits the new graph stays where it was.
  std::vector<Bound> before;
  std::swap(before, bound);
  for (Bound& b : before) {
    if (resized) break;
    try {
      bind(std::move(b));
    } catch (const InputError&) {
      // The port is gone or another now; recording says what is missing.
    }
  }
}

WeirStatus weirCreateGraph(WeirScene* scene, const WeirGraphInfo* info, WeirGraph** graph) {
  return call(weirOf(scene), [&] {
    given(graph, "graph") = nullptr;
    GraphSource source = graphSource(sized(info, "WeirGraphInfo"));
    checkSize(source.options.width, source.options.height);
    const trace::Backend backend = trace::chooseBackend(source.trace, scene->context.device);
    *graph = new WeirGraph(*scene, std::move(source), backend);
  });
}

WeirStatus weirDestroyGraph(WeirGraph* graph) {
  delete graph;
  return WEIR_OK;
}

WeirStatus weirSet(WeirGraph* graph, WeirTexts set) {
  return call(weirOf(graph), [&] {
    GraphSource next = graph->source;
    for (const std::string& text : texts(set, "set")) addSet(next.overrides.set, text);
    graph->change(std::move(next));
  });
}

WeirStatus weirEnable(WeirGraph* graph, const char* pass, uint32_t enabled) {
  return call(weirOf(graph), [&] {
    (void)given(pass, "pass");
    GraphSource next = graph->source;
    std::erase(next.overrides.enable, pass);
    std::erase(next.overrides.disable, pass);
    (enabled != 0 ? next.overrides.enable : next.overrides.disable).emplace_back(pass);
    graph->change(std::move(next));
  });
}

WeirStatus weirResize(WeirGraph* graph, uint32_t width, uint32_t height) {
  return call(weirOf(graph), [&] {
    GraphSource next = graph->source;
    next.options.width = width;
    next.options.height = height;
    graph->change(std::move(next));
  });
}

WeirStatus weirResetHistory(WeirGraph* graph) {
  return call(weirOf(graph), [&] { graph->frame.forget(); });
}
