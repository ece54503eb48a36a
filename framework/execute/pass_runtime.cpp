// A pass's kernels: from shader files to pipelines, and what they are bound to. pass_bindings.cpp has the descriptors.
#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/core/paths.h>
#include <weir/core/text.h>
#include <weir/execute/contexts.h>
#include <weir/execute/pass_runtime.h>

#include <filesystem>

namespace weir::execute {

PassRuntime::PassRuntime(Shared& shared, uint32_t index) : shared_(shared), index_(index) {
  const graph::CompiledPass& pass = compiled();
  Registry& registry = *shared.services.registry;
  if (registry.find(pass.type) != pass.description)
    throw RuntimeError(
        fmt::format("pass '{}': the plugin of '{}' was loaded anew; compile the graph again", pass.name, pass.type));
  pass_ = registry.create(pass.type);
  const scene::SceneGpu& scene = shared.frame->scene();
  interface_ = {shared.graph, &pass, {}, {}, shared.countRays, scene.textureCount(), scene.traits};
  push_.assign(pushBytes(*pass.description) / 4, 0);
  push_[3] = pass.stream;
  fillPush();
  for (const ParamDescription* p : specialParams(*pass.description))
    constants_.push_back(paramBits(*p, pass.params.at(p->name)));
}

void PassRuntime::prepare() {
  Preparing context(*this);
  pass_->prepare(context);
  // A pass that launches nothing takes its turn all the same: others wait for it, and it for others.
  if (stages_ == 0) stages_ = graph::kComputeStage;
}

PassRuntime::~PassRuntime() {
  VkDevice handle = device().handle();
  for (VkDescriptorPool pool : pools_) vkDestroyDescriptorPool(handle, pool, nullptr);
  for (const OwnTexture& t : textures_) vkDestroySampler(handle, t.sampler, nullptr);
  vkDestroyPipelineLayout(handle, pipelineLayout_, nullptr);
  vkDestroyDescriptorSetLayout(handle, setLayout_, nullptr);
}

void PassRuntime::record(const FrameCursor& cursor) {
  Recording context(*this, cursor);
  pass_->record(context);
}

void PassRuntime::fillPush() {
  const graph::CompiledPass& pass = compiled();
  for (const PushParam& p : pushParams(*pass.description))
    push_[p.offset / 4] = paramBits(*p.description, pass.params.at(p.description->name));
}

bool PassRuntime::accepts(const graph::CompiledPass& pass) const {
  for (const ParamDescription& p : pass.description->params) {
    if (pass.params.at(p.name) == compiled().params.at(p.name)) continue;
    if (p.specialises || p.type == ParamType::String || asked_.count(p.name) != 0) return false;
  }
  return true;
}

void PassRuntime::take(const graph::CompiledPass& pass) {
  compiled().params = pass.params;
  fillPush();
}

uint32_t PassRuntime::addScratch(graph::Resource resource) {
  resource.scratch = true;
  resource.producer = resource.firstUse = resource.lastUse = index_;
  const auto place = static_cast<uint32_t>(shared_.graph->resources.size());
  shared_.graph->resources.push_back(std::move(resource));
  compiled().scratch.push_back(place);
  return place;
}

std::vector<uint32_t> PassRuntime::compile(KernelKind kind, shader::Stage stage, const std::string& file,
                                           const KernelOptions& options) {
  shader::CompileRequest r;
  r.name = "prelude of " + compiled().name;
  r.source = kernelSource(interface_, kind, file, options);
  r.stage = stage;
  const std::filesystem::path own = shared_.services.registry->shaderFolder(compiled().type);
  if (!own.empty()) r.includeFolders.push_back(own.string());
  r.includeFolders.push_back(commonShaderFolder().string());
  for (const auto& [name, text] : options.sources) r.virtualFiles[name] = text;
  r.defines = options.defines;
  checkFile(file, r);
  return compile(r);
}

/// The compiler would say it too, but of the text that is put before a kernel, and without the nearest name.
void PassRuntime::checkFile(const std::string& file, const shader::CompileRequest& request) const {
  if (request.virtualFiles.count(file) != 0) return;
  std::vector<std::string> known;
  for (const std::string& folder : request.includeFolders) {
    std::error_code error;
    if (std::filesystem::is_regular_file(std::filesystem::path(folder) / file, error)) return;
    for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
      known.push_back(entry->path().filename().string());
    if (shared_.services.files) shared_.services.files->insert((std::filesystem::path(folder) / file).string());
  }
  const std::string nearest = nearestName(file, known);
  throw InputError(fmt::format("{} ({}): there is no shader '{}' in {}{}", compiled().name, compiled().type, file,
                               fmt::join(request.includeFolders, " or "),
                               nearest.empty() ? "" : fmt::format(" (nearest: '{}')", nearest)));
}

std::vector<uint32_t> PassRuntime::compile(const shader::CompileRequest& request) {
  std::set<std::string>* files = shared_.services.files;
  try {
    shader::Module module = shared_.services.compiler->compile(request);
    if (files) files->insert(module.files.begin(), module.files.end());
    return std::move(module.spirv);
  } catch (const shader::CompileError& error) {
    if (files) files->insert(error.files.begin(), error.files.end());
    throw;
  }
}

const HitShaders& PassRuntime::hitShaders() {
  if (shared_.hitShaders) return *shared_.hitShaders;
  const scene::SceneGpu& scene = shared_.frame->scene();
  auto compileHit = [&](const char* file, shader::Stage stage) {
    shader::CompileRequest r;
    r.name = std::string("prelude of ") + file;
    r.source = hitShaderSource(file, scene.textureCount(), scene.traits);
    r.stage = stage;
    r.includeFolders.push_back(commonShaderFolder().string());
    return compile(r);
  };
  shared_.hitShaders = HitShaders{
      compileHit("closest_hit.glsl", shader::Stage::ClosestHit),
      compileHit("closest_any_hit.glsl", shader::Stage::AnyHit), compileHit("closest_miss.glsl", shader::Stage::Miss),
      compileHit("shadow_any_hit.glsl", shader::Stage::AnyHit), compileHit("shadow_miss.glsl", shader::Stage::Miss)};
  return *shared_.hitShaders;
}

/// Everything that a pipeline is made from: its stages' code, constants, and the layout, which follows from the set
/// layouts and the size of the push constants.
std::string PassRuntime::pipelineKey(KernelKind kind, const std::vector<const std::vector<uint32_t>*>& spirv) const {
  std::string key = fmt::format("{} {} {}", static_cast<int>(kind),
                                reinterpret_cast<uint64_t>(shared_.frame->scene().layout()), push_.size());
  for (const graph::Binding& b : compiled().inputs) key += b.resource == graph::kNone ? '-' : 'i';
  for (const PortDescription& p : compiled().description->inputs) key += p.type.kind == PortKind::Image ? 'I' : 'B';
  for (const PortDescription& p : compiled().description->outputs) key += p.type.kind == PortKind::Image ? 'I' : 'B';
  for (const Scratch& s : interface_.scratch) key += s.type.kind == PortKind::Image ? 'I' : 'B';
  key += fmt::format(" {}{}", textures_.size(), interface_.lightTree ? "T" : "");
  for (const uint32_t constant : constants_) key += fmt::format(",{}", constant);
  for (const std::vector<uint32_t>* module : spirv) {
    const std::string_view bytes(reinterpret_cast<const char*>(module->data()), module->size() * 4);
    key += fmt::format(";{}:{:x}:{:x}", bytes.size(), fnv1a(bytes), fnv1a(bytes, fnv1a("another basis")));
  }
  return key;
}

Kernel PassRuntime::addKernel(KernelKind kind, const std::string& file, const KernelOptions& options) {
  makeLayouts();
  PreparedKernel kernel;
  kernel.slots = slotsFor(options);
  const std::string name = compiled().name + " " + file;
  PipelineLibrary& library = *shared_.services.pipelines;
  if (kind == KernelKind::Vertex) {
    const auto vertex = compile(KernelKind::Vertex, shader::Stage::Vertex, file, options);
    const auto fragment = compile(KernelKind::Fragment, shader::Stage::Fragment, file, options);
    kernel.pipeline = library.get(pipelineKey(kind, {&vertex, &fragment}), [&] {
      return Pipeline::raster(device(), pipelineLayout_, vertex, fragment, VK_FORMAT_R32_UINT, constants_, name);
    });
  } else if (kind == KernelKind::RayPipeline) {
    const auto generation = compile(kind, shader::Stage::RayGeneration, file, options);
    const HitShaders& hits = hitShaders();
    const std::vector<const std::vector<uint32_t>*> all = {&generation,       &hits.closestHit,   &hits.closestAnyHit,
                                                           &hits.closestMiss, &hits.shadowAnyHit, &hits.shadowMiss};
    kernel.pipeline = library.get(pipelineKey(kind, all), [&] {
      return Pipeline::rays(device(), pipelineLayout_, generation, hits, constants_, name);
    });
  } else {
    const auto spirv = compile(kind, shader::Stage::Compute, file, options);
    kernel.pipeline = library.get(pipelineKey(kind, {&spirv}), [&] {
      return Pipeline::compute(device(), pipelineLayout_, spirv, constants_, options.linear ? 0 : options.group.side,
                               name);
    });
  }
  stages_ |= kernel.pipeline->stages();
  kernels_.push_back(std::move(kernel));
  return {static_cast<uint32_t>(kernels_.size() - 1)};
}

}  // namespace weir::execute
