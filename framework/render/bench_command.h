// The command line that measures one configuration again.
#pragma once

#include <weir/render/bench_options.h>
#include <weir/render/bench_sweep.h>

#include <string>

namespace weir::render {

/// "weir bench graphs/restir_di.json --scene …", quoted for a POSIX shell, on one line. Paths are as they were given.
std::string benchCommand(const Configuration& configuration, const BenchOptions& options);

}  // namespace weir::render
