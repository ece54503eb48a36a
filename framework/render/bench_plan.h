// Plans: JSON files that say what a bench measures, over several scenes, and which tables are made of it.
// docs/bench.md has the format.
#pragma once

#include <weir/render/bench_options.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace weir::render {

/// One table of a report: a sweep's configurations, a row each, beside figures that somebody else has published.
struct BenchTable {
  std::string name, title;
  std::string sweep;                        ///< of the plan
  std::vector<std::string> knobs;           ///< "pass.param" or "pass.enabled": what the rows differ in
  std::map<std::string, double> published;  ///< milliseconds by knob values, "32" or "true,false"; unknown: not there
  std::string source;                       ///< of the published figures
};

struct BenchPlan {
  BenchSettings settings;
  std::vector<BenchPart> parts;
  std::vector<BenchTable> tables;
};

/// Graphs are relative to the plan's folder, and so are scenes, environments and references unless `scenes` names
/// another folder for them. Throws InputError when it can't be read, and graph::GraphError with all that is wrong:
/// unknown keys with the nearest, wrong kinds, values out of range, tables of sweeps that aren't there.
BenchPlan loadBenchPlan(const std::string& path, const std::string& scenes = "");

/// "1920x1080"; false when the text is no such thing.
bool parseSizeText(const std::string& text, uint32_t& width, uint32_t& height);

/// InputError naming the option: counts that make no sense, frames whose numbers don't fit into 32 bits, …
void checkSettings(const BenchSettings& settings);

}  // namespace weir::render
