// What names a compiled shader in the cache: a hash of everything that its SPIR-V depends on.
#pragma once

#include <weir/shader/sources.h>

#include <cstdint>
#include <string>

namespace weir::shader {

#ifdef NDEBUG
inline constexpr bool kShaderDebugInfo = false;
#else
inline constexpr bool kShaderDebugInfo = true;
#endif

struct Digest {
  uint64_t high = 0, low = 0;
  bool operator==(const Digest&) const = default;
  std::string hex() const;
};

/// Covers compiler, stage, name, defines, the text, and path and text of every file that `sources` followed.
Digest digestOf(const CompileRequest& request, const Sources& sources);

/// Compiler and settings in words; another version's SPIR-V is never taken from the cache.
std::string compilerVersion();

/// The SPIR-V that lies in `folder` for this key; empty when there is none or it isn't whole.
std::vector<uint32_t> readCached(const std::string& folder, const Digest& key);
void writeCached(const std::string& folder, const Digest& key, const std::vector<uint32_t>& spirv);

}  // namespace weir::shader
