// Bench files: read, written after every configuration, and merged. docs/bench.md has the format.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace weir::render {

/// A configuration that a bench is to measure.
struct PlannedConfiguration {
  std::string id;
  std::string label;                ///< for people
  std::vector<std::string> sweeps;  ///< of the plan, that have it
  bool operator==(const PlannedConfiguration&) const = default;
};

/// What was measured of one; the JSON is kept as it is, with what other versions add.
struct MeasuredConfiguration {
  std::string id, json;
};

struct BenchFile {
  std::string device, driver, trace, weir;
  uint32_t shard = 0, shards = 1;
  std::vector<PlannedConfiguration> planned;          ///< of all shards
  std::vector<MeasuredConfiguration> configurations;  ///< so far

  bool has(const std::string& id) const;
  /// What differs in what must agree between files of one bench, in words; empty: nothing.
  std::string conflict(const BenchFile& other) const;
};

/// Throws InputError naming file and fault: no JSON, nested too deeply, no bench file, another version, malformed or
/// repeated configurations.
BenchFile readBenchFile(const std::string& path);
/// In the plan's order; others (of earlier plans) follow as they are.
std::string benchFileText(const BenchFile& file);
/// FILE.json whole or not at all, and FILE.csv beside it. Throws RuntimeError.
void writeBenchFile(const std::string& path, const BenchFile& file);

struct Merged {
  BenchFile file;
  std::vector<std::string> missing;  ///< labels of planned configurations that no file has
};
/// All files' configurations, each once (the first file's that has it), names of pictures relative to `out`'s folder.
/// InputError unless header and plan are the same in all of them.
Merged mergeBenchFiles(const std::vector<std::string>& paths, const std::string& out);

/// One row a configuration, one column a figure: all that any of them has.
std::string benchCsv(const BenchFile& file);
/// "FILE.csv" of "FILE.json", or with another ending.
std::string besideBenchFile(const std::string& path, const std::string& ending);

}  // namespace weir::render
