// Tables of a plan as Markdown: what was measured, beside what somebody else has published.
#pragma once

#include <weir/render/bench_file.h>
#include <weir/render/bench_plan.h>

#include <string>

namespace weir::render {

/// A row a configuration of the table's sweep: knob values, published milliseconds, milliseconds and errors here. A
/// knob whose values change neither time nor error by more than their noise is called inert below its table. What was
/// not measured stays empty.
std::string benchTables(const BenchFile& file, const BenchPlan& plan);

}  // namespace weir::render
