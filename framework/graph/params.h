// What a file or the command line says of a parameter, as a value of the declared type.
#pragma once

#include <weir/graph/description.h>
#include <weir/pass/description.h>

#include <optional>
#include <string>

namespace weir::graph {

/// In the parameter's own type; nothing when it does not fit: another kind, out of range, no such choice.
std::optional<ParamValue> readParam(const ParamDescription& param, const ParamEntry& entry);
/// What fits, in words: "an integer from 1 to 4", "one of: biased, pairwise".
std::string expectedText(const ParamDescription& param);

}  // namespace weir::graph
