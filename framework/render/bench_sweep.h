// Graphs × combinations of swept values → compiled graphs, all of them checked before the first is measured.
#pragma once

#include <weir/graph/compile.h>
#include <weir/render/bench_options.h>

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace weir::render {

/// One thing to measure.
struct Configuration {
  size_t part = 0;    ///< which of the options' parts
  std::string graph;  ///< file
  graph::Overrides overrides;
  std::string label;                             ///< for people: graph and swept values
  std::vector<std::string> sweeps;               ///< names of all parts that have it
  std::map<std::string, ParamValue> settings;    ///< "pass.param" that were swept or set; "pass.enabled"
  std::map<std::string, ParamValue> parameters;  ///< of every pass that runs; "pass.enabled" of those switched off
  graph::CompiledGraph compiled;
  std::string id;  ///< 16 hexadecimal digits of everything that the figures depend on (bench_identity.h)
};

/// InputError for no values, empty or repeated ones, or a toggle that is neither true nor false.
void checkValues(const Sweep& sweep);

/// In the order of parts, graphs and values, the last sweep's changing fastest. Throws InputError for sweeps that name
/// what a graph doesn't have, and graph::GraphError with all that is wrong with any configuration.
std::vector<Configuration> expand(Laboratory& laboratory, const std::vector<BenchPart>& parts);

}  // namespace weir::render
