// GLSL to SPIR-V in process (glslang), with includes, defines and a cache on disk.
#pragma once

#include <weir/core/error.h>

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace weir::shader {

enum class Stage : uint8_t { Compute, RayGeneration, ClosestHit, AnyHit, Miss, Vertex, Fragment };

/// A shader that doesn't compile. what() lists "file:line: message" for every finding.
class CompileError : public RuntimeError {
 public:
  using RuntimeError::RuntimeError;
  /// Everything that was read, and what was looked for and not there: what hot reload watches until it is mended.
  std::vector<std::string> files;
};

struct CompileRequest {
  std::string name;    ///< for messages: the file's path, or what the text stands for
  std::string source;  ///< GLSL; may start without #version (460 is put in front)
  Stage stage = Stage::Compute;
  std::vector<std::string>
      includeFolders;  ///< searched in order for #include "x" after the including file's own folder
  std::map<std::string, std::string> virtualFiles;  ///< name → text; wins over folders
  std::vector<std::pair<std::string, std::string>> defines;
};

struct BufferBlock {
  std::string name;  ///< block name
  uint32_t set = 0, binding = 0;
  uint32_t arrayStride = 0;  ///< of its last, unsized member; 0 when it has none
};

struct Module {
  std::vector<uint32_t> spirv;
  std::vector<std::string> files;  ///< everything that was included: what hot reload watches
  bool fromCache = false;
};

/// Compiles for Vulkan 1.3 / SPIR-V 1.6. Thread-safe. Throws CompileError.
/// The cache key covers the preprocessed text (includes followed), stage, defines and the compiler's version; an
/// unreadable, truncated or foreign cache entry is compiled anew, and entries are written to a temporary file and
/// renamed.
class Compiler {
 public:
  /// `cacheFolder` empty: $WEIR_CACHE_DIR, else $XDG_CACHE_HOME/weir, else ~/.cache/weir; "-": no cache.
  /// `defines` stand before those of every request.
  explicit Compiler(const std::string& cacheFolder = {}, std::vector<std::pair<std::string, std::string>> defines = {});
  Module compile(const CompileRequest& request);

 private:
  std::string cacheFolder_;
  std::vector<std::pair<std::string, std::string>> defines_;
};

/// Storage-buffer blocks of a module by glslang's reflection of its source, for tests that host and shader agree.
std::vector<BufferBlock> reflectBuffers(const CompileRequest& request);

/// Reads a text file; InputError when it can't be.
std::string readFile(const std::string& path);

}  // namespace weir::shader
