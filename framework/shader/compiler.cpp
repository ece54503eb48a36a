#include <weir/core/cache_folder.h>
#include <weir/shader/compiler.h>
#include <weir/shader/digest.h>
#include <weir/shader/sources.h>

#include <algorithm>
#include <utility>

namespace weir::shader {
namespace {

size_t countFound(const Sources& sources) {
  return std::ranges::count_if(sources.files(), [](const auto& entry) { return entry.second != nullptr; });
}

/// Those on disk: a virtual file can't be watched. With `missing` also those that are not there.
std::vector<std::string> filesOnDisk(const Sources& sources, bool missing = false) {
  std::vector<std::string> paths;
  for (const auto& [path, file] : sources.files()) {
    if (file ? !file->isVirtual : missing) paths.push_back(path);
  }
  return paths;
}

}  // namespace

Compiler::Compiler(const std::string& cacheFolder, std::vector<std::pair<std::string, std::string>> defines)
    : cacheFolder_(weir::cacheFolder(cacheFolder)), defines_(std::move(defines)) {}

Module Compiler::compile(const CompileRequest& asked) {
  CompileRequest request = asked;
  request.defines.insert(request.defines.begin(), defines_.begin(), defines_.end());
  Sources sources(request);
  sources.followAll();
  const size_t followed = countFound(sources);
  const Digest key = digestOf(request, sources);
  Module module;
  module.files = filesOnDisk(sources);
  if (!cacheFolder_.empty()) {
    module.spirv = readCached(cacheFolder_, key);
    module.fromCache = !module.spirv.empty();
    if (module.fromCache) return module;
  }
  try {
    module.spirv = compileToSpirv(request, sources);
  } catch (CompileError& error) {
    error.files = filesOnDisk(sources, true);
    throw;
  }
  module.files = filesOnDisk(sources);
  // The scanner reads #include lines as they are commonly written. Where glslang found a file that it did not, the key
  // doesn't cover that file, so the result is used but not kept.
  if (!cacheFolder_.empty() && countFound(sources) == followed) writeCached(cacheFolder_, key, module.spirv);
  return module;
}

}  // namespace weir::shader
