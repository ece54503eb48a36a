#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/core/paths.h>
#include <weir/core/text.h>
#include <weir/render/bench_identity.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <vector>

namespace weir::render {
namespace {

namespace fs = std::filesystem;

uint64_t folderDigest(const fs::path& folder, uint64_t hash) {
  std::vector<fs::path> files;
  std::error_code failed;
  for (fs::recursive_directory_iterator i(folder, failed), end; !failed && i != end; i.increment(failed))
    if (i->is_regular_file()) files.push_back(i->path());
  std::ranges::sort(files);
  for (const fs::path& file : files)
    hash =
        fnv1a(fmt::format("{} {:016x}\n", file.lexically_relative(folder).string(), fileDigest(file.string())), hash);
  return hash;
}

std::string portsText(const graph::CompiledGraph& graph, const std::vector<graph::Binding>& ports) {
  std::string text;
  for (const graph::Binding& b : ports) {
    if (b.resource == graph::kNone) continue;
    const graph::Resource& r = graph.resources[b.resource];
    text += fmt::format(" {}={}{}:{}", b.port, r.name, b.previous ? "@previous" : "", r.bytes);
  }
  return text;
}

std::string cropText(const std::optional<Crop>& crop) {
  return crop ? fmt::format("{}", fmt::join(*crop, ",")) : std::string("default");
}

}  // namespace

uint64_t fileDigest(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(fmt::format("can't read '{}'", path));
  std::vector<char> block(1 << 20);
  uint64_t hash = fnv1a("");
  while (file) {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    hash = fnv1a(std::string_view(block.data(), static_cast<size_t>(file.gcount())), hash);
  }
  return hash;
}

BuildDigest::BuildDigest(Registry& registry) : registry_(registry) {
  const fs::path library = libraryFolder() / "libweir.so";
  std::error_code ignored;
  uint64_t hash = fs::is_regular_file(library, ignored) ? fileDigest(library.string()) : fnv1a("");
  hash = folderDigest(commonShaderFolder(), hash);
  text_ = fmt::format(WEIR_VERSION " {:016x}", hash);
}

uint64_t BuildDigest::ofType(const std::string& type) {
  const std::string plugin = type.substr(0, type.find('.'));
  const auto known = plugins_.find(plugin);
  if (known != plugins_.end()) return known->second;
  uint64_t hash = fnv1a(plugin);
  for (const fs::path& file : registry_.pluginFiles(plugin))
    hash = fnv1a(fmt::format("{:016x}", fileDigest(file.string())), hash);
  if (const fs::path shaders = registry_.shaderFolder(type); !shaders.empty()) hash = folderDigest(shaders, hash);
  return plugins_[plugin] = hash;
}

std::string graphText(const graph::CompiledGraph& graph, BuildDigest& build) {
  std::string text = fmt::format("graph {} {} {}x{}\n", graph.name, fs::path(graph.file).filename().string(),
                                 graph.width, graph.height);
  for (const graph::CompiledPass& pass : graph.passes) {
    text += fmt::format("pass {} {} {:016x}", pass.name, pass.type, build.ofType(pass.type));
    for (const auto& [name, value] : pass.params) text += fmt::format(" {}={}", name, toText(value));
    text += portsText(graph, pass.inputs) + " →" + portsText(graph, pass.outputs) + "\n";
  }
  for (const graph::GraphOutput& output : graph.outputs)
    text += fmt::format("output {} {}{}\n", output.name, graph.resources[output.resource].name,
                        output.previous ? "@previous" : "");
  return text;
}

std::string referenceText(const BenchReference& reference, const graph::CompiledGraph& graph, BuildDigest& build) {
  if (!reference.wanted()) return "";
  std::string text = reference.exact ? "exact " : "";
  if (!reference.file.empty()) return text + fmt::format("file {:016x}", fileDigest(reference.file));
  return text + fmt::format("{} restarts of {} frames of\n", reference.restarts, reference.frames) +
         graphText(graph, build);
}

std::string identityOf(const Configuration& configuration, const Stage& stage, const BenchOptions& options,
                       const BenchPlace& place, const std::string& reference, BuildDigest& build) {
  const BenchSettings& s = options.settings;
  std::string text = "bench 1\n" + build.text() + "\n" + graphText(configuration.compiled, build);
  text += fmt::format("scene {}\nlights {}\ncamera {}\nshading {}\nanimation {}\n", stage.sceneLabel, stage.lightsLabel,
                      stage.cameraLabel, stage.shadingLabel,
                      stage.playback
                          ? fmt::format("{} {} {}", stage.playback->clip, stage.playback->start, stage.playback->step)
                          : "none");
  text += fmt::format("device {}\ndriver {}\ntrace {}\n", place.device, place.driver, place.trace);
  text += fmt::format("warmup {} frames {} first {} seed {} floor {}\n", s.warmup, s.frames, s.firstFrame, s.seed,
                      options.floor != nullptr);
  if (!reference.empty())
    text += fmt::format("repeats {} frames {} every {} output {} flip {} crop {}\nreference {}", s.repeats,
                        s.errorFrames, s.errorEvery, s.output, s.flip, cropText(s.crop), reference);
  return fmt::format("{:016x}", fnv1a(text));
}

}  // namespace weir::render
