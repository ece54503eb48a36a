// What a measurement depends on, as a number: two configurations with the same id would give the same figures, but for
// noise. So a bench knows what it has measured already.
#pragma once

#include <weir/graph/compile.h>
#include <weir/pass/registry.h>
#include <weir/render/bench_options.h>
#include <weir/render/bench_sweep.h>

#include <cstdint>
#include <map>
#include <string>

namespace weir::render {

/// What files hold: the framework's library, plugins, and the shaders of both.
class BuildDigest {
 public:
  explicit BuildDigest(Registry& registry);
  /// Version, and a digest of the framework's library and shaders: "0.1.0 0123456789abcdef".
  const std::string& text() const { return text_; }
  /// Of the library and shaders of a pass type's plugin.
  uint64_t ofType(const std::string& type);

 private:
  Registry& registry_;
  std::string text_;
  std::map<std::string, uint64_t> plugins_;
};

/// FNV-1a of a file's bytes. InputError when it can't be read.
uint64_t fileDigest(const std::string& path);

/// A compiled graph in words: passes with type, parameters and connections, outputs, size, and the code of its plugins.
std::string graphText(const graph::CompiledGraph& graph, BuildDigest& build);

/// Where and how a configuration runs.
struct BenchPlace {
  std::string device, driver, trace;
};
/// What pictures are compared with, in words; empty without a reference. `graph`: compiled, of a rendered one.
std::string referenceText(const BenchReference& reference, const graph::CompiledGraph& graph, BuildDigest& build);

/// 16 hexadecimal digits. `stage`: of its part; `reference`: as referenceText().
std::string identityOf(const Configuration& configuration, const Stage& stage, const BenchOptions& options,
                       const BenchPlace& place, const std::string& reference, BuildDigest& build);

}  // namespace weir::render
