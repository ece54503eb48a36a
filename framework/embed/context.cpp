// Weir itself, the host's device, and what it lacks.
#include <fmt/ranges.h>
#include <weir/embed/call.h>

namespace weir::embed {

gpu::HostDevice hostDevice(const Weir& weir, const WeirHost& host) {
  gpu::HostDevice device;
  device.loader = host.getInstanceProcAddr;
  device.instance = host.instance;
  device.apiVersion = host.apiVersion;
  device.instanceExtensions = texts(host.instanceExtensions, "WeirHost.instanceExtensions");
  device.physical = host.physicalDevice;
  device.device = host.device;
  device.queue = host.queue;
  device.queueFamily = host.queueFamily;
  device.features = host.features;
  device.extensions = texts(host.deviceExtensions, "WeirHost.deviceExtensions");
  device.pipelineCacheFolder = weir.cacheFolder;
  return device;
}

namespace {

/// What the passes that would run need and this device lacks, one line a pass.
void addMissingOf(const graph::CompiledGraph& graph, const std::string& trace, const gpu::DeviceInfo& info,
                  std::vector<std::string>& lines) {
  const gpu::Capabilities& has = info.capabilities;
  std::vector<std::string> rays = info.missingForRays;
  if (rays.empty() && trace == "pipeline" && !has.rayPipeline)
    rays = {"VK_KHR_ray_tracing_pipeline with rayTracingPipeline"};
  if (rays.empty() && trace == "query" && !has.rayQuery) rays = {"VK_KHR_ray_query with rayQuery"};
  for (const graph::CompiledPass& pass : graph.passes) {
    const auto add = [&](const char* does, const std::vector<std::string>& missing) {
      if (!missing.empty())
        lines.push_back(fmt::format("pass '{}' ({}) {}: {}", pass.name, pass.type, does, fmt::join(missing, ", ")));
    };
    if (pass.description->has(Need::SceneAcceleration)) add("may trace rays", rays);
    if (pass.description->draws) add("rasterises", info.missingForRaster);
  }
}

}  // namespace
}  // namespace weir::embed

using namespace weir;
using namespace weir::embed;

WeirStatus weirOpen(const WeirOpenInfo* info, Weir** weir) {
  if (weir == nullptr || (info != nullptr && info->size != sizeof(WeirOpenInfo))) return WEIR_BAD_INPUT;
  *weir = nullptr;
  try {
    std::vector<std::string> folders;
    if (info != nullptr) folders = texts(info->pluginFolders, "WeirOpenInfo.pluginFolders");
    *weir = new Weir(pluginSearchPath(folders), info == nullptr ? "" : text(info->cacheFolder));
    return WEIR_OK;
  } catch (const InputError&) {
    return WEIR_BAD_INPUT;
  } catch (...) {
    return WEIR_FAILED;
  }
}

WeirStatus weirClose(Weir* weir) {
  if (weir == nullptr) return WEIR_OK;
  const WeirStatus status = call(weir, [&] { refuseWhile(weir->children, "contexts and needs are"); });
  if (status == WEIR_OK) delete weir;
  return status;
}

const char* weirMessage(const Weir* weir) {
  return weir == nullptr ? "the Weir is NULL" : weir->message.c_str();
}

WeirTexts weirLines(const Weir* weir) {
  if (weir == nullptr) return {nullptr, 0};
  // Made here, as the texts may have moved since they were added. Only pointers: the caller sees no change.
  auto& pointers = const_cast<Weir*>(weir)->linePointers;
  try {
    pointers.clear();
    for (const std::string& line : weir->lines) pointers.push_back(line.c_str());
  } catch (...) {
    return {nullptr, 0};
  }
  return {pointers.data(), static_cast<uint32_t>(pointers.size())};
}

WeirStatus weirCreateNeeds(Weir* weir, const WeirHost* host, WeirNeeds** needs) {
  return call(weir, [&] {
    given(needs, "needs") = nullptr;
    auto made = std::make_unique<WeirNeeds>(*weir, hostDevice(*weir, sized(host, "WeirHost")));
    weir->lines = made->needs.info().missing;
    *needs = made.release();
  });
}

VkPhysicalDeviceFeatures2* weirNeededFeatures(WeirNeeds* needs) {
  return needs == nullptr ? nullptr : needs->needs.features();
}

WeirTexts weirNeededExtensions(const WeirNeeds* needs) {
  if (needs == nullptr) return {nullptr, 0};
  const std::vector<const char*>& names = needs->needs.extensions();
  return {names.data(), static_cast<uint32_t>(names.size())};
}

WeirStatus weirDestroyNeeds(WeirNeeds* needs) {
  delete needs;
  return WEIR_OK;
}

WeirStatus weirMissing(Weir* weir, const WeirHost* host, const WeirGraphInfo* graph) {
  return call(weir, [&] {
    const gpu::DeviceInfo info = gpu::inspect(hostDevice(*weir, sized(host, "WeirHost")));
    std::vector<std::string> lines;
    for (const std::string& missing : info.missing) lines.push_back("Weir needs " + missing);
    if (graph != nullptr) {
      const GraphSource source = graphSource(sized(graph, "WeirGraphInfo"));
      addMissingOf(compile(*weir, source), source.trace, info, lines);
    }
    weir->lines = std::move(lines);
  });
}

WeirStatus weirCreateContext(Weir* weir, const WeirHost* host, WeirContext** context) {
  return call(weir, [&] {
    given(context, "context") = nullptr;
    *context = new WeirContext(*weir, hostDevice(*weir, sized(host, "WeirHost")));
  });
}

WeirStatus weirDestroyContext(WeirContext* context) {
  if (context == nullptr) return WEIR_OK;
  const WeirStatus status = call(weirOf(context), [&] { refuseWhile(context->children, "scenes are"); });
  if (status == WEIR_OK) delete context;
  return status;
}
