// Parameters and ports in words, for people.
#pragma once

#include <weir/pass/description.h>

#include <string>
#include <vector>

namespace weir::view {

struct ParamModel;

/// Doc, what fits, default, and what a change costs: some lines for a tooltip.
std::string paramWords(const ParamDescription& param);
/// "Reservoir, 2 a pixel" or "RGBA32F image, 1/2 of the size". `params`: of the pass whose output it is, for counts
/// that a parameter says.
std::string portWords(const PortType& type, const std::vector<ParamModel>& params);

}  // namespace weir::view
